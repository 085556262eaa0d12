// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualProblem.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

namespace Haptos {

DualProblem makeDualProblem(RCP<const DualOperator> F, RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT,
                            const MultiVector& f, const Vector& c) {
  DualProblem dual;
  dual.F = F;
  dual.G = G;
  dual.GGT = GGT;
  dual.P = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::KernelOfG));
  dual.Q = Teuchos::rcp(new Projector(G, GGT, Projector::Onto::ImageOfGT));
  dual.PFP = Teuchos::rcp(new ProjectedDualOperator(F, G, GGT));
  const JumpOperator& B = F->jump();
  Vector u(B.getDomainMap());
  F->systems().applyPseudoInverse(B.primalOffsets(), f, u);
  auto h = Teuchos::rcp(new Vector(c, Teuchos::Copy));
  B.apply(u, *h, Teuchos::NO_TRANS, 1.0, -1.0);  // h = B K^+ f - c
  dual.h = h;
  dual.e = G->restrictLoad(f, F->systems());
  auto lambdaIm = Teuchos::rcp(new Vector(F->getDomainMap()));
  G->applyGT(GGT->solve(dual.e), *lambdaIm);
  dual.lambdaIm = lambdaIm;
  return dual;
}

RCP<Vector> recoverPrimal(const DualProblem& dual, const MultiVector& f, const Vector& c, const Vector& lambda, const Vector& s) {
  const JumpOperator& B = dual.F->jump();
  Vector residual(B.getDomainMap());
  residual.update(1.0, f, 0.0);
  B.apply(lambda, residual, Teuchos::TRANS, -1.0, 1.0);
  auto u = Teuchos::rcp(new Vector(B.getDomainMap()));
  dual.F->systems().applyPseudoInverse(B.primalOffsets(), residual, *u);
  Vector rigid(s, Teuchos::Copy);  // G^T a = s - (B K^+ (f - B^T l) - c)
  rigid.update(1.0, c, 1.0);
  B.apply(*u, rigid, Teuchos::NO_TRANS, -1.0, 1.0);
  dual.G->addRigidMotion(dual.GGT->solveSum(dual.G->partOfG(rigid)), dual.F->systems(), *u);
  return u;
}

}  // namespace Haptos
