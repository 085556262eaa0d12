// SPDX-License-Identifier: BSD-3-Clause
// A stranger's dual contact problem of operators of its own, solved by name through Belos' factory, by both managers of Haptos.
//
//   minimise 1/2 x^T F x - h^T x   with  x_N >= 0 and (x_T1/a1)^2 + (x_T2/a2)^2 <= 1 for every pair,   and G x = e or without it
//
// F = D + V V^T is known by its products alone.  G has five rows, which is no multiple of what a subdomain's motions are.  Both
// managers and the conditions of optimality must agree, on any number of ranks.
#include <BelosSolverFactory_Tpetra.hpp>
#include <Haptos_BoundEllipseSet.hpp>
#include <Haptos_SmalseSolMgr.hpp>
#include <Haptos_SubspaceNewtonSolMgr.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

namespace {

using Haptos::GlobalOrdinal;
using Haptos::Map;
using Haptos::MultiVector;
using Haptos::Operator;
using Haptos::Vector;
using Teuchos::RCP;
using Teuchos::rcp;

constexpr int kPairs = 24, kGluing = 15, kColumns = 4, kEqualities = 5;
constexpr double kSemiAxes[2] = {0.5, 0.25};

double number(GlobalOrdinal row, int column) { return std::sin(1.7 * double(row + 1) + 2.9 * column * double(row % 7 + 1)); }

// D + V V^T with the sum of all ranks; D grows along the rows.
class OwnF : public Operator {
 public:
  explicit OwnF(const RCP<const Map>& map) : map_(map) {}
  RCP<const Map> getDomainMap() const override { return map_; }
  RCP<const Map> getRangeMap() const override { return map_; }
  double diagonal(GlobalOrdinal row) const { return 1 + 0.02 * double(row % 11); }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
      const auto from = x.getData(v);
      const auto to = y.getDataNonConst(v);
      double mine[kColumns] = {}, all[kColumns];
      for (int i = 0; i < int(from.size()); ++i)
        for (int k = 0; k < kColumns; ++k) mine[k] += number(map_->getGlobalElement(i), k) * from[i];
      Teuchos::reduceAll(*map_->getComm(), Teuchos::REDUCE_SUM, kColumns, mine, all);
      for (int i = 0; i < int(from.size()); ++i) {
        const GlobalOrdinal row = map_->getGlobalElement(i);
        double sum = diagonal(row) * from[i];
        for (int k = 0; k < kColumns; ++k) sum += number(row, k) * all[k] / 20;
        to[i] = alpha * sum + (beta == 0 ? 0 : beta * to[i]);
      }
    }
  }

 private:
  RCP<const Map> map_;
};

// Of F roughly: 1 / diagonal
class OwnM : public Operator {
 public:
  OwnM(const RCP<const Map>& map, const RCP<Vector>& diagonal) : map_(map), diagonal_(diagonal) {}
  RCP<const Map> getDomainMap() const override { return map_; }
  RCP<const Map> getRangeMap() const override { return map_; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    y.elementWiseMultiply(alpha, *diagonal_, x, beta);
  }

 private:
  RCP<const Map> map_;
  RCP<Vector> diagonal_;
};

// Q = G^T (G G^T)^-1 G
class OwnQ : public Operator {
 public:
  OwnQ(const RCP<const Map>& map, const Eigen::MatrixXd& GT) : map_(map), GT_(GT) {
    const Eigen::MatrixXd mine = GT.transpose() * GT;
    Eigen::MatrixXd all(mine.rows(), mine.cols());
    Teuchos::reduceAll(*map->getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    inverse_ = all.inverse();
  }
  RCP<const Map> getDomainMap() const override { return map_; }
  RCP<const Map> getRangeMap() const override { return map_; }
  Eigen::VectorXd multiplyG(const Vector& x) const {
    const Eigen::VectorXd mine = GT_.transpose() * Eigen::Map<const Eigen::VectorXd>(x.getData(0).getRawPtr(), GT_.rows());
    Eigen::VectorXd all(mine.size());
    Teuchos::reduceAll(*map_->getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    return all;
  }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    const Eigen::VectorXd Qx = GT_ * (inverse_ * multiplyG(*x.getVector(0)));
    const auto to = y.getDataNonConst(0);
    for (int i = 0; i < int(to.size()); ++i) to[i] = alpha * Qx[i] + (beta == 0 ? 0 : beta * to[i]);
  }

 private:
  RCP<const Map> map_;
  Eigen::MatrixXd GT_, inverse_;
};

// Pairs are dealt to the ranks in turn with their three rows, gluing rows after them.
struct Problem {
  Problem(const RCP<const Haptos::Communicator>& comm, int equalities) {
    std::vector<GlobalOrdinal> rows;
    for (int pair = comm->getRank(); pair < kPairs; pair += comm->getSize())
      for (int c = 0; c < 3; ++c) rows.push_back(3 * pair + c);
    pairsHere = int(rows.size()) / 3;
    for (int g = comm->getRank(); g < kGluing; g += comm->getSize()) rows.push_back(3 * kPairs + g);
    map = rcp(new Map(3 * kPairs + kGluing, Teuchos::ArrayView<const GlobalOrdinal>(rows.data(), rows.size()), 0, comm));
    F = rcp(new OwnF(map));
    h = rcp(new Vector(map));
    inside = rcp(new Vector(map));
    GT.resize(Eigen::Index(rows.size()), equalities);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool isNormal = rows[i] < 3 * kPairs && rows[i] % 3 == 0, isGluing = rows[i] >= 3 * kPairs;
      h->replaceLocalValue(int(i), (isNormal ? 1.2 : 0.6) * std::sin(0.9 * double(rows[i] + 1)));
      inside->replaceLocalValue(int(i), isNormal ? 0.3 : isGluing ? 0.2 : 0.02);  // well within the set
      for (int k = 0; k < equalities; ++k) GT(Eigen::Index(i), k) = (isGluing ? 1 : 0.2) * number(rows[i] + 5, k + 3);
    }
    if (equalities > 0) Q = rcp(new OwnQ(map, GT));
  }

  RCP<const Map> map;
  int pairsHere = 0;
  RCP<OwnF> F;
  RCP<OwnQ> Q;
  RCP<Vector> h, inside;
  Eigen::MatrixXd GT;  // rows of this rank
};

RCP<Belos::SolverManager<double, MultiVector, Operator>> create(const std::string& name, double tolerance) {
  const auto parameters = Teuchos::parameterList();
  parameters->set("Convergence Tolerance", tolerance);
  return Belos::SolverFactory<double, MultiVector, Operator>().create(name, parameters);
}

RCP<Vector> solveBySmalse(const Problem& p) {
  std::vector<Haptos::BoundEllipseSet::Bound> bounds;
  std::vector<Haptos::BoundEllipseSet::Ellipse> ellipses;
  for (int i = 0; i < p.pairsHere; ++i) {
    bounds.push_back({3 * i, 0.0});
    ellipses.push_back({{3 * i + 1, 3 * i + 2}, {kSemiAxes[0], kSemiAxes[1]}, {0.0, 0.0}});
  }
  const auto x = rcp(new Vector(p.map));
  const auto set = rcp(new Haptos::BoundEllipseSet(p.map, bounds, ellipses));
  using Program = Haptos::QuadraticProgram<double, MultiVector, Operator>;
  const auto manager = create("Haptos SMALSE", 1e-12);
  manager->setProblem(rcp(new Program(p.F, x, p.h, set, p.Q, p.Q.is_null() ? Teuchos::null : RCP<const MultiVector>(p.inside))));
  if (manager->solve() != Belos::Converged) throw std::runtime_error("SMALSE did not converge");
  return x;
}

RCP<Vector> solveByNewton(const Problem& p) {
  Haptos::ContactOperators o;
  o.F = rcp(new Haptos::CountedOperator(p.F));
  o.h = p.h;
  const auto diagonal = rcp(new Vector(p.map));
  const auto rows = diagonal->getLocalLength();
  for (int i = 0; i < int(rows); ++i) diagonal->replaceLocalValue(i, 1 / (p.F->diagonal(p.map->getGlobalElement(i)) + 0.1));
  o.M = rcp(new OwnM(p.map, diagonal));
  o.diagonalOfM = diagonal;
  const auto GT = rcp(new Haptos::CoarseRows(p.GT.sparseView()));
  o.GT = GT;
  o.GGT = rcp(new Haptos::CoarseProblem(*p.map->getComm(), *GT, {}, {}));
  o.e = p.Q.is_null() ? Eigen::VectorXd() : p.Q->multiplyG(*p.inside);
  o.motions.resize(p.GT.cols(), 0);
  for (int i = 0; i < int(rows); ++i) {
    if (i >= 3 * p.pairsHere) o.gluingRows.push_back(i);
    else if (i % 3 == 0) o.pairs.push_back({i, {i + 1, i + 2}, {kSemiAxes[0], kSemiAxes[1]}, 1.0, Haptos::FrictionLaw::Tresca, false});
  }
  const auto x = rcp(new Vector(p.map));
  const auto manager = create("HAPTOS subspace newton", 1e-12);
  manager->setProblem(rcp(new Haptos::ContactProblem(o, x)));
  if (manager->solve() != Belos::Converged) throw std::runtime_error("Subspace Newton did not converge");
  return x;
}

struct Findings {
  double worst = 0;
  int counts[4] = {};  // pressed, lifted, inside, sliding
};

// With g = F x - h + G^T y, y by least squares on rows that are free: g = 0 on those, g >= 0 at bounds, -g along the outward
// normal of an ellipse where it is reached.
Findings examine(const Problem& p, const Vector& x) {
  Vector g(p.map);
  p.F->apply(x, g, Teuchos::NO_TRANS, 1, 0);
  g.update(-1.0, *p.h, 1.0);
  const auto xv = x.getData(0);
  const auto gv = g.getDataNonConst(0);
  Findings found;
  std::vector<char> isFree(std::size_t(xv.size()), 1);
  const auto level = [&](int i) { return std::hypot(xv[i + 1] / kSemiAxes[0], xv[i + 2] / kSemiAxes[1]); };
  for (int i = 0; i < 3 * p.pairsHere; i += 3) {
    isFree[i] = xv[i] > 1e-9;
    isFree[i + 1] = isFree[i + 2] = level(i) < 1 - 1e-9;
    ++found.counts[isFree[i] ? 0 : 1];
    ++found.counts[isFree[i + 1] ? 2 : 3];
    found.worst = std::max({found.worst, -xv[i], level(i) - 1});
  }
  const Eigen::Index l = p.GT.cols();
  if (l > 0) {
    Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(l, l + 1), all(l, l + 1);
    for (Eigen::Index i = 0; i < p.GT.rows(); ++i)
      if (isFree[std::size_t(i)]) {
        mine.leftCols(l) += p.GT.row(i).transpose() * p.GT.row(i);
        mine.col(l) -= p.GT.row(i).transpose() * gv[i];
      }
    Teuchos::reduceAll(*p.map->getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    const Eigen::VectorXd y = all.leftCols(l).ldlt().solve(all.col(l));
    for (Eigen::Index i = 0; i < p.GT.rows(); ++i) gv[i] += p.GT.row(i).dot(y);
    found.worst = std::max(found.worst, (p.Q->multiplyG(x) - p.Q->multiplyG(*p.inside)).norm());
  }
  for (int i = 0; i < int(xv.size()); ++i)
    if (isFree[std::size_t(i)]) found.worst = std::max(found.worst, std::abs(gv[i]));
  for (int i = 0; i < 3 * p.pairsHere; i += 3) {
    if (!isFree[i]) found.worst = std::max(found.worst, -gv[i]);
    if (isFree[i + 1]) continue;
    const double n[2] = {xv[i + 1] / (kSemiAxes[0] * kSemiAxes[0]), xv[i + 2] / (kSemiAxes[1] * kSemiAxes[1])};
    const double t = -(gv[i + 1] * n[0] + gv[i + 2] * n[1]) / (n[0] * n[0] + n[1] * n[1]);
    found.worst = std::max({found.worst, -t, std::abs(gv[i + 1] + t * n[0]), std::abs(gv[i + 2] + t * n[1])});
  }
  return found;
}

bool run(const RCP<const Haptos::Communicator>& comm, int equalities) {
  const Problem p(comm, equalities);
  const auto x = solveBySmalse(p), y = solveByNewton(p);
  Vector difference(*x, Teuchos::Copy);
  difference.update(-1.0, *y, 1.0);
  const double apart = difference.normInf() / x->normInf(), length = x->norm2();
  bool good = apart < 1e-9;
  for (const auto& solution : {x, y}) {
    const Findings mine = examine(p, *solution);
    double worst = 0;
    int counts[4];
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, mine.worst, Teuchos::outArg(worst));
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 4, mine.counts, counts);
    if (comm->getRank() == 0)
      std::printf("%d equalities: violation %.1e; pressed %d, lifted %d, inside %d, sliding %d; length %.9e; apart %.1e\n", equalities, worst,
                  counts[0], counts[1], counts[2], counts[3], length, apart);
    good = good && worst < 1e-9 && counts[0] > 3 && counts[1] > 3 && counts[2] > 3 && counts[3] > 3;
  }
  return good;
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  Haptos::registerSmalseSolMgr();
  Haptos::registerSubspaceNewtonSolMgr();
  const auto world = Tpetra::getDefaultComm();
  const int half = (world->getSize() + 1) / 2;
  const auto mine = world->split(world->getRank() < half ? 0 : -1, world->getRank());  // the others have something else to do
  int good = 1, all = 0;
  if (!mine.is_null())
    for (int equalities : {kEqualities, 0}) good = run(mine, equalities) && good;
  Teuchos::reduceAll(*world, Teuchos::REDUCE_MIN, good, Teuchos::outArg(all));
  return all ? 0 : 1;
}
