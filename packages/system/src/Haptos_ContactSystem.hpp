// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ArrayView.hpp>
#include <Teuchos_ParameterList.hpp>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_StepSolver.hpp"

namespace Haptos {

/// \brief A subdomain of one rank: its nodes and its stiffness by itself, nothing held and nothing merged (Neumann).
struct SubdomainInput {
  int body = 0;                                   ///< bodies are numbered from 0 without gaps, over all ranks
  Teuchos::ArrayView<const GlobalOrdinal> nodes;  ///< ids >= 0, of one body each; the same id in two subdomains is the same material point
  Teuchos::ArrayView<const double> coordinates;   ///< [3 x nodes]
  /// [3 x nodes], row 3 x node + component, on one rank; shared, not copied, and needed as long as the system
  RCP<const CrsMatrix> K;
  /// [3 nodes x k] by columns: all that K does not feel, where that is more than rigid motions; empty: rigid motions are tried
  Teuchos::ArrayView<const double> kernel = {};
};

/// \brief A node of the secondary side and what it may touch: [u] = u_secondary - sum of weight x u_primary.
///
/// Better the softer side than one that is far stiffer, and not one whose nodes supports hold and are more than those opposite: how its pairs share a force
/// nobody decides (decisions/057).
struct PairInput {
  int interface = 0;        ///< from addInterface
  GlobalOrdinal secondary;  ///< id of a node
  std::vector<std::pair<GlobalOrdinal, double>> primary;  ///< ids and weights, which add up to 1; none: a rigid obstacle
  std::array<double, 3> normal;  ///< outward from the secondary side
  std::array<double, 3> axis;    ///< first principal axis of friction, projected on the tangent plane
  double gap = 0;   ///< [length] along the normal; more than a million times the model counts as that; of no effect on ties
  double area = 1;  ///< tributary area of the node; only Tresca's law needs it
};

/// \brief Bodies in contact with friction, for programs that assemble by themselves: matrices and pairs in, u and lambda out,
/// solved again and again.  Friction resists the whole slip since the state without loads: no solve remembers the one before.
///
///   minimise 1/2 u^T K u - f^T u  with contact and friction on the pairs, u = prescribed where it is
///
/// No mesh, no file.  Any rank may bring any subdomain, element, pair or prescribed value, each of them once.  What is given
/// after a solve changes the next one, and only what it touches is done again:
///
///   loads                       one K^+
///   gap, prescribed value       right-hand side
///   friction                    laws
///   pairs                       rows of B, G, G G^T, surface matrices; sparse factors stay
///   values of K                 factors and all that is made of them; the multipliers are where the next solve starts
///
/// The communicator is duplicated: messages of this object meet no others, and several systems may live at once.  Errors are
/// thrown on all ranks by the Collective calls (setUp, solve).  What an addition was refused for was not taken, and may be given
/// anew; what is wrong with a matrix or a pair that was taken is seen by setUp, and stays: pairs and prescribed values can be cleared, for
/// another matrix make another system.
class ContactSystem {
 public:
  /// \param parameters sublists Solver, Local Solver, Preconditioner, Coarse Problem, Decomposition as in the input of the
  /// program (doc/input.md); null: defaults.  Collective.
  /// \throws InputError for unknown names and values out of range
  explicit ContactSystem(const RCP<const Communicator>& comm, const RCP<const Teuchos::ParameterList>& parameters = {});
  /// \brief For a model that is dealt to the ranks already: `solver()` is used then, and nothing is added.
  ContactSystem(SystemModel model, SystemOptions options, StepSolver::Observer observer);
  ~ContactSystem();

  /// \name What is solved.  Local, but for the interfaces, which all ranks add alike.
  /// @{
  int addInterface(std::string name, const FrictionSpec& friction);
  /// \brief Returns whether it was taken; what was wrong else is told by the next Collective call.
  bool addSubdomain(const SubdomainInput& subdomain);
  /// \brief Places of the nodes of elements that this rank adds, [3 x nodes].
  void addNodes(Teuchos::ArrayView<const GlobalOrdinal> nodes, Teuchos::ArrayView<const double> coordinates);
  /// \brief A stiffness [3 nodes x 3 nodes] that is not merged with others, instead of subdomains: the system cuts them.
  /// Returns the number of the element on this rank, -1 where it was refused.
  int addElement(int body, Teuchos::ArrayView<const GlobalOrdinal> nodes, Teuchos::ArrayView<const double> Ke);
  void setElement(int element, Teuchos::ArrayView<const double> Ke);  ///< other values, by its number on this rank
  /// \brief u_component(node) = value; once more after a solve: another value.
  void prescribe(GlobalOrdinal node, int component, double value);
  void clearPrescribed();  ///< all that this rank prescribed
  /// \brief Returns the number of the pair on this rank.
  int addPair(const PairInput& pair);
  void clearPairs();
  void setGap(int pair, double gap);
  void setFriction(int interface, const FrictionSpec& friction);  ///< the same on all ranks
  void updateStiffness();  ///< the matrices have other values; their patterns stay
  void setTolerance(double tolerance);  ///< `Relative Tolerance` of the next solves [-]; the same on all ranks
  /// @}

  /// \brief Cuts, checks and numbers what was added; `solve` does it where it was not done.  Collective.
  /// \throws InputError, InsufficientModel on all ranks
  void setUp();

  /// \brief Unknowns 3 x id + component, each on one rank that has the node in a subdomain.  After setUp.
  RCP<const Map> map() const;

  struct Outcome {
    bool solved = false;      ///< kkt <= Relative Tolerance
    std::string reason;       ///< why not
    std::string method;
    double kkt = 0;           ///< largest error of equilibrium, continuity and contact laws, see Accuracy
    long multiplications = 0;  ///< by F, for this solve
  };
  /// \brief u for nodal loads f, both on `map`; goes on from the solve before.  Collective.
  Outcome solve(const Vector& f, Vector& u);

  RCP<const Vector> multipliers() const;  ///< of the last solve: reactions, gluing and contact forces by row
  /// \brief (lambda_N, lambda_T1, lambda_T2) of every pair that this rank added [force], along its normal, t1 and t2 = normal x t1 (`makeFrame`); a
  /// lambda_N > 0 presses, and the secondary side feels -lambda.  Collective.
  /// \throws InputError on all ranks if nothing is solved, or pairs, supports or kinds of laws are others since
  std::vector<std::array<double, 3>> contactForces() const;

  /// \brief Work since construction, over all ranks.  Collective.
  struct Counters {
    long factorizations = 0;   ///< of subdomain matrices; congruent ones share theirs
    long multiplications = 0;  ///< by F = B K^+ B^T
    long rows = 0;             ///< times that rows of B were made
  };
  Counters counters() const;

  StepSolver& solver();
  const StepSolver& solver() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace Haptos
