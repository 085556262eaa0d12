// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief All numbers that steer the subspace Newton method, each with what speaks for it.
///
/// F counts multiplications by F, r is the penalty of the law phi = (lambda - P(lambda + r s)) / r.  Residuals are || (s_E, phi) ||.
/// Counts in the comments are of the two beams at kkt 1e-6.  Thresholds that only tell zero from round-off stand where they are used.
struct SubspaceNewtonOptions {
  double tolerance = 1e-6;           ///< what the status test's residual is compared with
  int maximumMultiplications = SolverOptions{}.maximumMultiplications;
  /// Memory, not convergence: 30 pairs were enough on the two beams, 15 were not.
  int maximumPairs = SolverOptions{}.maximumRecycledPairs;
  /// r relative to the nodal stiffness where friction alone holds a body: at 0.98 of the sliding limit 1 runs away (1332 F),
  /// 0.3 takes 16.
  double floatingPenalty = 0.3;

  /// \brief Levels of friction before the true coefficients.  All pairs are kept between levels, so they cost little.
  struct Continuation {
    /// Axis ratios up to this need no levels: 10 itself took 29 F without, circles 20.
    double firstAxisRatio = 10;
    /// Above it the ratio rises by this from level to level.
    double axisRatioStep = 4;
    /// The last level before the true one, times the coefficients: without it a body near the limit of friction took 171 instead
    /// of 27 F.
    double firstFactor = 1.5;
    /// Residual that ends a level, of the start's jumps; at 0.1 the true level has too few pairs and a plateau (48 against 32 F at
    /// s = 256).
    double levelTolerance = 0.03;
    int levelPatience = 25;  ///< F without halving the residual that end a level: levels may be slow, they need not end well
    int patience = 12;       ///< the same at the true coefficients; where all is well one or two F halve it
    int maximumRestarts = 2; ///< one for each row of `detourFactors`; then another method is better
    /// Twice the patience where an answer is improved: its last digits are slower, and a restart would throw away the answer.
    int patienceFactorAtAnswer = 2;

    /// A stall drops all pairs (those of a runaway only add spurious minima) and comes back through more levels: by axis ratios,
    /// or by these factors of the coefficients, finer the second time.
    double detourAxisRatio = 2, detourAxisRatioStep = 2.5;
    std::vector<std::vector<double>> detourFactors = {{1.5, 1.2}, {2.0, 1.6, 1.3, 1.15, 1.07}};
    double detourTolerance = 0.01;  ///< of such a level: closer, as the first way was too loose
    int detourPatience = 20;
    /// Residual that directions for one linearisation aim at in the true level, of the tolerance: kkt is a maximum norm with scales
    /// of its own.
    double aim = 0.1;
  };

  /// \brief One step of the iteration.
  struct Steps {
    int gaussNewtonSteps = 8;      ///< in the subspace, between two directions; once under way the first one does all
    /// Residual that a further one promises; beyond, all eleven trials would fail (176 of 190 in one run, decisions/010).
    double worthTrying = 0.9999;
    double hardlyLess = 0.98;      ///< a step that leaves so much is the last one: a direction is worth more
    double armijo = 1e-4;          ///< descent asked of a step, relative to its length: any real one
    double shortestStep = 1.0 / 40;  ///< six trials of the line search; then damped steps
    std::array<double, 4> dampings{1e-3, 1e-2, 1e-1, 1.0};  ///< of the small system with columns of length 1
    /// Growth of the contact jumps in a step where contact alone holds bodies; what friction hardly resists went 1e5 to 1e9 times as far, where
    /// phi is small and no solution near.
    double farthest = 10;
    /// A first full step without descent is taken up to this much above the best residual: it lets the active set move.
    double ascent = 3;
    /// The step that a direction was made for is taken up to there, too, where what is reached otherwise leaves this much: from the same state the
    /// same direction would come again.  .98 left one of three needles at 148 F, .8 took 46 instead of 21 in another (decisions/052).
    double stays = 0.9;
    double roundOff = 1e-13;       ///< of the jumps at the start: a residual below is not freed of rigid motions, it would fall to 0 (decisions/010)

    int window = 3;                ///< steps over which the residual must fall by windowFactor; else the way is poor
    double windowFactor = 0.6;
    /// The same where condensed directions can be had: they leave a third each.  At .6 round-off decided whether a way of .8 a step was poor.
    double windowFactorOfBetter = 0.45;
    /// And in the first so many steps of a level, whose rate is not yet that of the way: a better M costs 100 to 300 F (decisions/042).
    double windowFactorAtFirst = 0.5;
    int firstSteps = 6;
    /// Where so many steps leave less than `deafFalls` of the residual, and change what is measured by less than `deafChange`, balance and jumps are made anew.
    int deafSteps = 2;
    double deafFalls = 0.25, deafChange = 0.01;
    /// r relative to the nodal stiffness, tried in turn on a poor way; the pairs do not depend on it.  1 alone took 71 F in one
    /// cell of twenty, 0.3 alone more than 40 in four.
    std::array<double, 3> penalties{1.0, 0.3, 0.1};

    /// Condensed directions go round them; a round that leaves more was for nothing: a slow but sure one left .42 to .86 (decisions/045).
    double roundLeaves = 0.9;

    /// Then inexact Newton steps: directions for one linearisation until its residual is `forcing`, relative.  Without them axis
    /// ratios of 1000 fail.
    double forcing = 0.2;
    double tightestForcing = 0.3;  ///< of what the level asks for: no linearisation is solved beyond it
    int maximumDirections = 40;    ///< for one linearisation; an axis ratio of 1000 needs about twenty before anything falls
    /// They get three times the patience, for that reason (52 against 231 F).
    int linearPatience = 3;
    int passPatience = 2;          ///< and within a pass twice that: cut off, its directions would be for nothing
    /// Directions in a row whose model was not solved from where the state is: a fresh start takes fewer (78 F became 28).
    int hopelessDirections = 2;
    double goodStep = 0.5;         ///< a step that leaves less is good
    int goodSteps = 2;             ///< so many, and directions are made for the law of every step again
    double idle = 0.9;             ///< a linearisation that leaves more adds a direction the next time: no endless loop without F
    /// A poor way that ends after so many steps at its rate is not left for the condensed problem, which needs about as many.
    double fewSteps = 15;
    /// Where M is likely to be poor, a way of more steps than this, by what so many have brought, is left as well (decisions/042).
    int slowLook = 20, slowSteps = 40;
    /// The same where a better M is to be had at any price only, by all F so far: with it 15 to 20 are left, and up to three times the seconds
    /// (decisions/050).
    double longWay = 100;
  };

  /// \brief Directions that the active coarse projection balances (`BalancedDirection`).
  struct Balanced {
    /// Root mean square change of P' (eigenvalues in [0, 1]) from which the active coarse matrix is made anew: 12 set-ups instead of
    /// 20, same counts; at 0.2 METIS parts take up to two F more.
    double coarseChange = 0.1;
    int sweeps = 2;  ///< that balance by the law; each leaves about a tenth, the coefficient of friction times the coupling
    /// Of q in (M^-1 + C)^-1, relative.  1e-3 costs up to three F at contrasts of 1e6; a stiff body that floats on a soft one moves where q is small beside
    /// its largest entries, 1e-3 ran away, 1e-5 does not; at 1e-4 round-off decides on the fourth digit of a step, at 1e-6 on the sixth (decisions/015).
    double slipTolerance = 1e-6;
    int slipSteps = 60;  ///< of conjugate gradients, one reduction each; 10 to 30 are taken mostly
    /// What contact forces push floating bodies with is spread by H^T r P' H, made regular by these parts of its trace and of
    /// H^T r H.
    double floatingShift = 1e-8, floatingHold = 1e-10;
  };

  /// \brief The contact problem condensed to the contact rows (`CondensedContact`).  No number here costs an F.
  struct Condensed {
    /// Of phi: about what one F leaves.  1e-9 took as many F on all scenes with long axes, and four times the products with M.
    double reduction = 1e-2;
    /// The same where subdomains are slender: phi hides jumps of stiff motions behind those of soft ones (1e-2 took up to four times
    /// the F, 1e-5 lost one scene).  1e-9 is round-off in some: three paths were followed for each direction (decisions/040).
    double reductionSlender = 1e-6;
    /// r relative to the nodal stiffness.  Bodies give way softer than a node does, by bending 1e2 to 1e5 times: at 1 phi hides forces behind jumps, and a
    /// scene had no answer; 87 scenes took 1446, 1373 F with 1, .05; with .001 twice the seconds.  From .1 to .01 they hardly differ (decisions/054).
    double penalty = 0.05;
    int newtonSteps = 12;          ///< from a start near the solution two or three do; what needs more is a case for the path
    /// Full steps go too far where v^T F v is this much of v^T M^-1 v: M is scaled for that to be `asFar`, but not by less than `leastScaling` at a time, as
    /// at the end both are round-off.  At 2 they diverge; 1.5 and 1 took as many F, 2 and 1.6 a third more (decisions/052).
    double tooFar = 1.8, asFar = 1.3, leastScaling = 0.2;
    /// Up to so many where pairs leave few rows to be factored, as long as `newtonSteps` of them leave this much: 28 to 36 were seen where
    /// 1200 of 1381 pairs came to be open, each a tenth of a step of the path (decisions/040).
    int smallSteps = 100;
    double smallLeaves = 0.5;
    /// Before a path r times these, by so many steps, to so much of `reduction`: steps cost less than those of a path, which one scene needed three of
    /// for each direction (decisions/054).
    std::array<double, 2> otherPenalties{0.1, 0.01};
    /// Those that get there have 19 to 27, and are on their way after `newtonSteps`: at the rate of the last `courseSteps` it must not be more than
    /// `patientSteps` to their end.  To 40 steps each time they took two thirds of a scene (decisions/054).
    int patientSteps = 40, courseSteps = 8;
    double otherReduction = 0.1;
    /// Where a path has stages to begin at, and no coarse space serves both, Newton's method ends where the last so many steps leave more (decisions/040).
    int trialSteps = 2;
    double trialLeaves = 0.5;
    double farthest = 10;          ///< growth of the jumps that ends it where friction holds bodies; 1e3 to 1e6 where it goes wrong
    double leastStep = 1e-3;       ///< of the line search; then the step of the least residual, or the full one
    double armijo = 1e-4;
    double linearTolerance = 1e-3; ///< of a Newton step, 20 to 30 products
    int linearSteps = 150;         ///< a bound
    /// Where that does not do, the dense matrix is factored, if it has at most so many rows a step: n^3 2/3 operations at 2e10 a second are as
    /// much as n / 40 products that read n^2 entries at 5e8, or more by what they read less.
    int rowsOfStep = 40;  ///< decisions/040
    /// Products that read more than half of the dense matrix have it made once they are one for so many rows: a row of
    /// it costs about a twelfth of a product by energies (decisions/049).
    int productsOfRow = 12;
    /// Beyond so many rows it is read from memory, at this price an entry, while what products read of M mostly lies in a processor's own: with 2646 rows 1.75 ms,
    /// where products that read half as much again took .9 (decisions/049).
    int rowsInCache = 2000;
    double readFromMemory = 2;
    /// Groups of pairs (`SchwarzPreconditioner`) from so many rows on: below, a factor of all rows costs no more than those of groups.  Entries that products
    /// read in the time in which groups are factored, and made, for each row: 7 us and 40 us (decisions/049).
    int groupRows = 1000;
    double groupFactor = 1.5e4, groupSetUp = 5e4;
    /// Solves by groups that take more steps on the mean get coarse jumps beside them (`ContactCoarse`), once that many products are made; so many solves
    /// in a row that do not end show that it is no help.
    int coarseSteps = 20, coarseProducts = 100, coarseTrials = 3;
    /// A factor before serves where at most so many pairs changed by more than a tenth, by so many steps of GMRES.
    int changedPairs = 10, stepsByLast = 8;
    /// The path of interior points: 20 to 27 steps from no start to 1e-7, on models with axis ratios of 6e2 to 1e4.
    int pathSteps = 40;
    /// Of phi that Newton's method must leave for a path; `reductionSlender` where subdomains are slender.  An F leaves a tenth and more of the law: with
    /// 1e-2 one scene took 50 s instead of 15 and as many F, .3 took up to five F more in others (decisions/044).
    double pathFrom = 0.1;
    /// Its matrices add up to 1e6 times M to some rows: 1e-2 lost the path, 1e-4 the last digits.
    double pathLinearTolerance = 1e-6;
    double pathFar = 0.1;          ///< of l . y that a step aims at at least; more by the part of the way that leads to 0
    /// So many long steps in a row that leave so much of the law: |F s_T| lags behind, which its derivative ends at twice the price of a step.
    /// After one step of .7 as many steps of the dear kind as were saved, after none 23 steps that left .85 were seen.
    int pathPatience = 3;
    double pathLong = 0.5, pathLags = 0.6;
    double pathShortest = 1e-6;    ///< step that ends the path
    /// So many steps that leave this much of the least residual end it, too: 33 steps for nothing were seen, by two seconds each.
    int pathStall = 8;
    double pathStalls = 0.5;
    /// A path begins at the last stage of the one before whose jumps leave so much more of the law than they did there: 6 to 9 steps
    /// instead of 23.
    double stageGrowth = 2;
    /// So many steps in a row that creep end such a path: 28 to 40 of them were taken where one from no start has 16.
    int stagePatience = 3;
    double pathCreeps = 0.2;
  };

  /// \brief Rigid bodies on a frictional foundation, where floating bodies start (`solveFoundation`); no F.
  struct Foundation {
    int steps = 100;
    double tolerance = 1e-12;      ///< of the load: balance is exact from the start on
    /// Of the mean spring: Newton's matrix has no inverse where all springs of a motion slip or are open.
    std::array<double, 7> dampings{0.0, 1e-6, 1e-4, 1e-2, 1e-1, 1.0, 10.0};
    double shortestStep = 1e-2, armijo = 1e-3;
    /// Of the least jumps: less than 10 in 118 scenes; where it is 2e3 or 2e6 nothing holds the springs, and round-off of the way decides (decisions/055).
    double farthest = 100;
  };

  Continuation continuation;
  Steps steps;
  Balanced balanced;
  Condensed condensed;
  Foundation foundation;

  /// \brief The parameters of `SubspaceNewtonSolMgr`: those that a user may want to change.
  static const OptionTable<SubspaceNewtonOptions>& table();
};

}  // namespace Haptos
