// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualProblem.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_LocalSystems.hpp"

namespace Haptos {

DualProblem::DualProblem(RCP<const DualOperator> dualOperator, RCP<const NaturalCoarseSpace> coarseSpace, RCP<const CoarseProblem> coarse)
    : F(std::move(dualOperator)), G(std::move(coarseSpace)), GGT(std::move(coarse)) {
  P = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::KernelOfG));
  Q = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::ImageOfGT));
  PFP = Teuchos::rcp(new ProjectedDualOperator(F, G, GGT));
}

// The point of least norm with G l = e is G^T (G G^T)^-1 e; h is the jump that loads alone would leave, minus c.
void DualProblem::setStep(StepData data) {
  step = std::move(data);
  const JumpOperator& B = F->jump();
  Vector u(B.getDomainMap());
  F->systems().applyPseudoInverse(B.primalOffsets(), *step.f, u);
  const auto jumps = Teuchos::rcp(new Vector(*step.c, Teuchos::Copy));
  B.apply(u, *jumps, Teuchos::NO_TRANS, 1.0, -1.0);  // h = B K^+ f - c
  h = jumps;
  e = G->restrictLoad(*step.f, F->systems());
  const auto image = Teuchos::rcp(new Vector(F->getDomainMap()));
  G->applyGT(GGT->solve(e), *image);
  lambdaIm = image;
}

// u = K^+ (f - B^T l) + R a.  B u - c = s is to hold: G^T a = s + c - B K^+ (f - B^T l), in the sense of least squares
// a = (G G^T)^-1 G (s + c - B K^+ (f - B^T l)).
RCP<Vector> recoverPrimal(const DualProblem& dual, const Vector& lambda, const Vector& s) {
  const JumpOperator& B = dual.F->jump();
  Vector residual(B.getDomainMap());
  residual.update(1.0, *dual.step.f, 0.0);
  B.apply(lambda, residual, Teuchos::TRANS, -1.0, 1.0);
  auto u = Teuchos::rcp(new Vector(B.getDomainMap()));
  dual.F->systems().applyPseudoInverse(B.primalOffsets(), residual, *u);
  Vector rigid(s, Teuchos::Copy);  // G^T a = s - (B K^+ (f - B^T l) - c)
  rigid.update(1.0, *dual.step.c, 1.0);
  B.apply(*u, rigid, Teuchos::NO_TRANS, -1.0, 1.0);
  dual.G->addRigidMotion(dual.GGT->solveSum(dual.G->partOfG(rigid)), dual.F->systems(), *u);
  return u;
}

}  // namespace Haptos
