// SPDX-License-Identifier: BSD-3-Clause
// The operators of a small decomposed scene, and the same as dense matrices made by other means.
#pragma once
#include "../../decomposition/tests/DecomposedScene.hpp"
#include "DenseAlgebra.hpp"
#include "Haptos_BodyMotions.hpp"
#include "Haptos_CoarseProblem.hpp"
#include "Haptos_DualOperator.hpp"
#include "Haptos_ElasticStiffness.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"
#include "Haptos_Projector.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos::Testing {

struct Feti {
  RCP<const Communicator> comm;
  Dealt dealt;
  RCP<LocalSystems> systems;
  RCP<DualOperator> F;
  RCP<NaturalCoarseSpace> G;

  const RCP<const Map> map() const { return dealt.jump->getRangeMap(); }
};

/// \param subdomains must outlive what is returned
inline std::shared_ptr<const SubdomainStiffness> stiffnessOf(const std::vector<Subdomain>& subdomains, const Scene& scene) {
  return std::make_shared<ElasticStiffness>(subdomains, scene.materials, Formulation::Standard);
}

inline BodyMotions bodyMotions(const Feti& feti, const Scene& scene) {
  std::vector<int> bodies;
  for (const auto& sub : feti.dealt.mine) bodies.push_back(sub.body);
  return {*feti.G, *feti.systems, bodies, scene.bodies.names};
}

using MakeStiffness = std::function<std::shared_ptr<const SubdomainStiffness>(const std::vector<Subdomain>&, const Scene&)>;

inline Feti makeFeti(const RCP<const Communicator>& comm, const Scene& scene, LocalDual dual = LocalDual::Implicit,
                     const MakeStiffness& makeStiffness = stiffnessOf) {
  Feti feti;
  feti.comm = comm;
  feti.dealt = deal(comm, scene);
  feti.systems = Teuchos::rcp(new LocalSystems(makeStiffness(feti.dealt.mine, scene)));
  feti.systems->assemble();
  feti.systems->factor(TouchedUnknowns(*feti.systems, *feti.dealt.jump), LocalSolverMethod::Automatic, dual);
  feti.F = Teuchos::rcp(new DualOperator(feti.dealt.jump, feti.systems));
  feti.G = Teuchos::rcp(new NaturalCoarseSpace(feti.dealt.jump, *feti.systems));
  return feti;
}

/// Columns A e_i of an operator, on all ranks; 0 where its maps have no row.
inline Dense denseOf(const Operator& A) {
  const auto n = Eigen::Index(A.getDomainMap()->getMaxAllGlobalIndex()) + 1;
  const auto x = scatteredColumns(A.getDomainMap(), Dense::Identity(n, n));
  MultiVector y(A.getRangeMap(), std::size_t(n));
  A.apply(*x, y);
  return gathered(y);
}

/// K of all subdomains, block by block.
inline std::vector<Dense> denseStiffness(const Scene& scene) {
  std::vector<Dense> K;
  for (const auto& sub : scene.subdomains)
    K.push_back(Dense(assembleStiffness(sub.coordinates, sub.groups, scene.materials, Formulation::Standard)));
  return K;
}

/// Pseudo-inverse by the spectrum, for symmetric positive semidefinite matrices.
inline Dense densePseudoInverse(const Dense& A, double relative = 1e-10) {
  const SymmetricSpectrum spectrum(A);
  const double cut = relative * std::max(1e-300, spectrum.values.cwiseAbs().maxCoeff());
  Eigen::VectorXd inverse = spectrum.values;
  for (auto& value : inverse) value = value > cut ? 1.0 / value : 0.0;
  return spectrum.vectors * inverse.asDiagonal() * spectrum.vectors.transpose();
}

/// F = B K^+ B^T.
inline Dense denseF(const Scene& scene) {
  const Dense B = denseB(scene);
  const auto K = denseStiffness(scene);
  const auto offsets = scene.offsets();
  Dense F = Dense::Zero(B.rows(), B.rows());
  for (std::size_t s = 0; s < K.size(); ++s) {
    const Dense Bs = B.middleCols(offsets[s], K[s].rows());
    F += Bs * densePseudoInverse(K[s]) * Bs.transpose();
  }
  return F;
}

inline double smallestEigenvalue(const Dense& A) {
  return symmetricEigenvalues(0.5 * (A + A.transpose()))[0];
}

/// Both bodies held at x = 0, contact between, six subdomains or so.
inline SceneOptions heldScene(int subdomains) {
  SceneOptions options;
  options.lower = {3, 2, 2};
  options.upper = {3, 2, 2};
  options.subdomains = subdomains;
  options.hold = [](int, const Point& x) { return std::string(x[0] < 1e-9 ? "xyz" : ""); };
  return options;
}

}  // namespace Haptos::Testing
