// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeflatedMotions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "Haptos_Error.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_NeighbourStiffness.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SoftModes.hpp"
#include "Haptos_SpectralModes.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

constexpr double kStiffer = 4;  // theta of motions that are deflated: with 10 counts are half as high again (decisions/042)

void append(const Eigen::MatrixXd& more, Eigen::MatrixXd& all) {
  all.conservativeResize(Eigen::NoChange, all.cols() + more.cols());
  all.rightCols(more.cols()) = more;
}

Eigen::MatrixXd rigidMotions(const DualPreconditioner& base, int i) {
  const LocalSystem& system = base.systems()[i];
  const auto& dofs = base.surface().boundary(system.congruenceClass);
  Eigen::MatrixXd rigid(Eigen::Index(dofs.size()), system.R().cols());
  for (std::size_t k = 0; k < dofs.size(); ++k) rigid.row(Eigen::Index(k)) = system.R().row(dofs[k]);
  return rigid;
}

class MotionFinder {
 public:
  MotionFinder(const DualPreconditioner& base, const DeflatedMotions::Spectra& wanted)
      : base_(base), systems_(base.systems()), comm_(*base.getRangeMap()->getComm()), wanted_(wanted) {
    result_.ofSubdomains.resize(std::size_t(systems_.size()));
    result_.L.resize(std::size_t(systems_.numClasses()));
    result_.S.resize(result_.L.size());
  }

  std::optional<DeflatedMotions> find(const std::vector<char>& slender);

 private:
  Eigen::MatrixXd denseOf(int congruenceClass) const;
  std::vector<SpectralModes> findSpectralModes() const;
  void findModesOfClass(std::size_t c, const NeighbourStiffness& neighbours, std::vector<SpectralModes>& spectral) const;
  void takeSoftModes(const std::vector<SoftSpectrum>& soft);
  bool takeSpectralModes(const std::vector<SpectralModes>& spectral);
  double boundThatLeaves(long most, double bound, const std::function<long(double)>& countMine) const;

  const DualPreconditioner& base_;
  const LocalSystems& systems_;
  const Communicator& comm_;
  const DeflatedMotions::Spectra& wanted_;
  DeflatedMotions result_;
};

std::optional<DeflatedMotions> MotionFinder::find(const std::vector<char>& slender) {
  const auto isSlender = [&](int c) { return slender[std::size_t(systems_.members()[std::size_t(c)].front())] != 0; };
  const auto hasSpectrum = [&](int c) { return !isSlender(c) && int(base_.surface().boundary(c).size()) <= wanted_.largestBoundary; };
  bool mine = false;
  for (int c = 0; c < systems_.numClasses(); ++c) mine = mine || hasSpectrum(c);
  const bool any = anyOfAll(comm_, mine);
  std::vector<SoftSpectrum> soft(result_.L.size());
  runOnAllRanks(comm_, [&] {
    for (int c = 0; c < systems_.numClasses(); ++c) {
      const auto& members = systems_.members()[std::size_t(c)];
      const Eigen::MatrixXd rigid = rigidMotions(base_, members.front());
      for (int i : members) result_.ofSubdomains[std::size_t(i)] = rigid;
      if (!isSlender(c) && !hasSpectrum(c)) continue;
      Eigen::MatrixXd Sc = denseOf(c);
      if (isSlender(c)) {
        soft[std::size_t(c)] = softSpectrum(Sc, rigid);
        result_.L[std::size_t(c)] = std::move(soft[std::size_t(c)].L);
      }
      if (any) result_.S[std::size_t(c)] = std::move(Sc);
    }
  });
  takeSoftModes(soft);
  if (any && !takeSpectralModes(findSpectralModes())) return {};
  return std::move(result_);
}

// Where there are too many, the softest: what is left out costs far less than soft motions without any (decisions/016).
void MotionFinder::takeSoftModes(const std::vector<SoftSpectrum>& soft) {
  const auto& members = systems_.members();
  const auto below = [&](std::size_t c, double bound) { return (soft[c].mu.array() * bound < 1).count(); };
  const double bound = boundThatLeaves(wanted_.columns - result_.count(comm_), 1, [&](double b) {
    long mine = 0;
    for (std::size_t c = 0; c < soft.size(); ++c) mine += below(c, b) * long(members[c].size());
    return mine;
  });
  for (std::size_t c = 0; c < soft.size(); ++c)
    if (const Eigen::Index k = below(c, bound); k > 0)
      for (int i : members[c]) append(soft[c].modes.leftCols(k), result_.ofSubdomains[std::size_t(i)]);
}

Eigen::MatrixXd MotionFinder::denseOf(int congruenceClass) const {
  std::vector<int> all(base_.surface().boundary(congruenceClass).size());
  std::iota(all.begin(), all.end(), 0);
  return base_.surface().block(congruenceClass, all);
}

// [local subdomains] of those that are not slender.  Ends where this rank alone has too many that are too stiff to be left out.
std::vector<SpectralModes> MotionFinder::findSpectralModes() const {
  const auto& S = result_.S;
  std::vector<SpectralModes> spectral(std::size_t(systems_.size()));
  const NeighbourStiffness neighbours(base_, S);
  runOnAllRanks(comm_, [&] {
    long stiffest = 0;
    for (std::size_t c = 0; c < S.size() && stiffest <= wanted_.most; ++c) {
      if (S[c].size() == 0 || result_.L[c].size() > 0) continue;
      findModesOfClass(c, neighbours, spectral);
      for (int i : systems_.members()[c]) stiffest += (spectral[std::size_t(i)].theta.array() > wanted_.stiffestLeft).count();
    }
  });
  return spectral;
}

// Congruent subdomains among the same neighbours have the same modes: energies are compared by their products with one vector.
void MotionFinder::findModesOfClass(std::size_t c, const NeighbourStiffness& neighbours, std::vector<SpectralModes>& spectral) const {
  constexpr double kAlike = 1e-10;
  const Eigen::MatrixXd& S = result_.S[c];
  const Eigen::VectorXd probe = Eigen::VectorXd::LinSpaced(S.rows(), 1, 2);
  std::vector<std::pair<Eigen::VectorXd, int>> known;
  for (int i : systems_.members()[c]) {
    const Eigen::MatrixXd energy = neighbours.energy(i);
    const Eigen::VectorXd print = energy * probe;
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& k) { return (k.first - print).norm() <= kAlike * print.norm(); });
    spectral[std::size_t(i)] = same != known.end() ? spectral[std::size_t(same->second)] : spectralModes(S, energy, rigidMotions(base_, i), kStiffer);
    if (same == known.end()) known.emplace_back(print, i);
  }
}

// Where there are too many, those that matter least are left out.
bool MotionFinder::takeSpectralModes(const std::vector<SpectralModes>& spectral) {
  const auto above = [](const SpectralModes& s, double bound) { return (s.theta.array() > bound).count(); };
  const double bound = boundThatLeaves(std::min(wanted_.most, wanted_.columns - result_.count(comm_)), kStiffer, [&](double b) {
    long mine = 0;
    for (const auto& s : spectral) mine += above(s, b);
    return mine;
  });
  if (bound > wanted_.stiffestLeft) return false;
  for (std::size_t i = 0; i < spectral.size(); ++i)
    if (spectral[i].modes.cols() > 0) append(spectral[i].modes.leftCols(above(spectral[i], bound)), result_.ofSubdomains[i]);
  return true;
}

// The same for all ranks: the first of growing ones beyond which they have at most so many together, or that is infinite.
double MotionFinder::boundThatLeaves(long most, double bound, const std::function<long(double)>& countMine) const {
  constexpr double kStep = 1.25;
  while (std::isfinite(bound) && sumOfAll(comm_, countMine(bound)) > std::max(0L, most)) bound *= kStep;
  return bound;
}

}  // namespace

long DeflatedMotions::count(const Communicator& comm) const {
  long mine = 0;
  for (const auto& motions : ofSubdomains) mine += motions.cols();
  return sumOfAll(comm, mine);
}

std::optional<DeflatedMotions> DeflatedMotions::find(const DualPreconditioner& base, const std::vector<char>& slender, const Spectra& wanted) {
  return MotionFinder(base, wanted).find(slender);
}

DeflatedMotions DeflatedMotions::given(const DualPreconditioner& base, const std::vector<Eigen::MatrixXd>& soft) {
  const LocalSystems& systems = base.systems();
  DeflatedMotions result;
  result.L.resize(std::size_t(systems.numClasses()));
  result.S.resize(result.L.size());
  for (int i = 0; i < systems.size(); ++i) {
    result.ofSubdomains.push_back(rigidMotions(base, i));
    append(soft[std::size_t(systems[i].congruenceClass)], result.ofSubdomains.back());
  }
  return result;
}

}  // namespace Haptos
