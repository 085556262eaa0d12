// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualProblem.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {

DualProblem::DualProblem(RCP<const DualOperator> dualOperator, RCP<const NaturalCoarseSpace> coarseSpace, RCP<const CoarseProblem> coarse)
    : F(std::move(dualOperator)), G(std::move(coarseSpace)), GGT(std::move(coarse)) {
  P = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::KernelOfG));
  Q = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::ImageOfGT));
  PFP = Teuchos::rcp(new ProjectedDualOperator(F, G, GGT));
}

// The point of least norm with G l = e is G^T (G G^T)^-1 e.
void DualProblem::setStep(StepData data) {
  step = std::move(data);
  recent_ = {};
  e = G->restrictLoad(*step.f, F->systems());
  const auto image = Teuchos::rcp(new Vector(F->getDomainMap()));
  G->applyGT(GGT->solve(e), *image);
  lambdaIm = image;
}

// u = K^+ (f - B^T l) and B u - c
DualProblem::Response DualProblem::respond(const RCP<const Vector>& lambda) const {
  const JumpOperator& B = F->jump();
  Vector forces(*step.f, Teuchos::Copy);
  B.apply(*lambda, forces, Teuchos::TRANS, -1.0, 1.0);
  const auto u = Teuchos::rcp(new Vector(B.getDomainMap()));
  F->systems().applyPseudoInverse(B.primalOffsets(), forces, *u);
  const auto jumps = Teuchos::rcp(new Vector(*step.c, Teuchos::Copy));
  B.apply(*u, *jumps, Teuchos::NO_TRANS, 1.0, -1.0);
  return {lambda, u, jumps};
}

// Told by values: a vector may come again with others.
bool DualProblem::isRecent(const Vector& lambda) const {
  if (recent_.lambda.is_null()) return false;
  const auto a = recent_.lambda->getData(0), b = lambda.getData(0);
  return !anyOfAll(*lambda.getMap()->getComm(), !std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

RCP<const Vector> DualProblem::jumpsOf(const Vector& lambda) const {
  if (!isRecent(lambda)) {
    recent_ = respond(Teuchos::rcp(new Vector(lambda, Teuchos::Copy)));
    F->count(1);
  }
  return recent_.jumps;
}

// u = K^+ (f - B^T l) + R a.  B u - c = s is to hold: G^T a = s - (B K^+ (f - B^T l) - c), in the sense of least squares
// a = (G G^T)^-1 G (s - (B K^+ (f - B^T l) - c)).
RCP<Vector> recoverPrimal(const DualProblem& dual, const Vector& lambda, const Vector& s) {
  const auto response = dual.isRecent(lambda) ? dual.recent_ : dual.respond(Teuchos::rcpFromRef(lambda));
  const auto u = Teuchos::rcp(new Vector(*response.u, Teuchos::Copy));
  Vector rigid(s, Teuchos::Copy);
  rigid.update(-1.0, *response.jumps, 1.0);
  dual.G->addRigidMotion(dual.GGT->solveSum(dual.G->partOfG(rigid)), dual.F->systems(), *u);
  return u;
}

}  // namespace Haptos
