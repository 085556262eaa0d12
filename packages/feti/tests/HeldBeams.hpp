// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Core.hpp>
#include <array>

#include "FetiScene.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos::Testing {

/// \brief Two beams of bricks in METIS parts, held at one end, and their Dirichlet preconditioner in double precision.
struct HeldBeams {
  Scene scene;
  Feti feti;
  RCP<DualPreconditioner> M;

  explicit HeldBeams(double height, double distortion = 0, const std::array<int, 3>& bricks = {4, 2, 2}, int parts = 4) {
    SceneOptions options = heldScene(parts);
    options.lower = options.upper = bricks;
    options.distortion = distortion;
    options.height = height;
    scene = makeScene(options);
    feti = makeFeti(Tpetra::getDefaultComm(), scene);
    const std::vector<char> all(feti.dealt.mine.size(), 1);
    M = Teuchos::rcp(new DualPreconditioner(
        feti.dealt.jump, feti.systems,
        SurfaceOperators(*feti.systems, {*feti.systems, *feti.dealt.jump}, PreconditionerKind::Dirichlet, LocalSolverMethod::Automatic, all)));
  }
};

}  // namespace Haptos::Testing
