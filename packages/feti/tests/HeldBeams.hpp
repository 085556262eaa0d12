// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos::Testing {

/// \brief Two beams of 4 x 2 x 2 bricks in four METIS parts, held at one end, and their Dirichlet preconditioner in double precision.
struct HeldBeams {
  Scene scene;
  Feti feti;
  RCP<DualPreconditioner> M;

  explicit HeldBeams(double height, double distortion = 0) {
    SceneOptions options = heldScene(4);
    options.lower = options.upper = {4, 2, 2};
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
