// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "Haptos_Choices.hpp"

// What steers the methods, as plain values.  It stands below all packages, because those that obey it do not know the
// input, and the input does not know them.  A member's default, and its line in `table()`, are where a parameter is defined:
// the input and the solver managers make their valid parameters from them.
namespace Haptos {

template <class Options>
struct Option;
template <class Options>
class OptionTable;

/// \brief Which direct solver factors a subdomain.  `Automatic`: CHOLMOD where it was built in, else KLU2.
enum class LocalSolverMethod { Automatic, Cholmod, Klu2 };
template <>
struct Choices<LocalSolverMethod> {
  using E = LocalSolverMethod;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::Cholmod, "CHOLMOD"}, {E::Klu2, "KLU2"}};
};

/// \brief How K^+ acts in an application of F: by solves with a sparse factor, by dense matrices on the surface, or
/// for every class of congruent subdomains by what is predicted to be faster.
enum class LocalDual { Automatic, Implicit, Explicit };
template <>
struct Choices<LocalDual> {
  using E = LocalDual;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::Implicit, "Implicit"}, {E::Explicit, "Explicit"}};
};

struct LocalSolverOptions {
  LocalSolverMethod method = LocalSolverMethod::Automatic;
  LocalDual dual = LocalDual::Automatic;

  static const OptionTable<LocalSolverOptions>& table();
};

enum class PreconditionerKind { Dirichlet, Lumped };
template <>
struct Choices<std::optional<PreconditionerKind>> {
  using E = PreconditionerKind;
  static constexpr Choice<std::optional<E>> all[] = {{E::Dirichlet, "Dirichlet"}, {E::Lumped, "Lumped"}, {std::nullopt, "None"}};
};

struct PreconditionerOptions {
  std::optional<PreconditionerKind> kind = PreconditionerKind::Dirichlet;

  static const OptionTable<PreconditionerOptions>& table();
};

/// \brief Where the factor of a coarse matrix lives.
struct CoarseOptions {
  int replicatedUpTo = 1500;  ///< coarse unknowns up to which every rank has a factor
  int ranksPerFactor = 0;     ///< beyond it: ranks in whose name one holds a factor; 0: all ranks share one

  static const OptionTable<CoarseOptions>& table();
};

enum class PartitionMethod { Metis, Bricks, Block };
template <>
struct Choices<PartitionMethod> {
  using E = PartitionMethod;
  static constexpr Choice<E> all[] = {{E::Metis, "METIS"}, {E::Bricks, "Bricks"}, {E::Block, "Block"}};
};

struct DecompositionOptions {
  PartitionMethod method = PartitionMethod::Metis;
  int subdomains = 0;  ///< total over all bodies; 0 chooses
  int seed = 1;

  static const OptionTable<DecompositionOptions>& table();
};

/// \brief How two surfaces are joined; Automatic: node to node where the meshes match.
enum class Discretization { Automatic, NodeToNode, Mortar };
template <>
struct Choices<Discretization> {
  using E = Discretization;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::NodeToNode, "Node To Node"}, {E::Mortar, "Mortar"}};
};

/// \brief Which of two surfaces carries the multipliers of mortar; Automatic: the softer one, of two alike the finer.
enum class ContactSides { Automatic, AsGiven };
template <>
struct Choices<ContactSides> {
  using E = ContactSides;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::AsGiven, "As Given"}};
};

/// \brief Multipliers on quadratic faces of mortar: Automatic and Full at all nodes where a face is covered as a whole, Linear at corners.
enum class MultiplierSpace { Automatic, Full, Linear };
template <>
struct Choices<MultiplierSpace> {
  using E = MultiplierSpace;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::Full, "Full"}, {E::Linear, "Linear"}};
};

enum class FrictionLaw { Frictionless, Tresca, Coulomb };
/// Nothing: Tied, which is no law of contact.
template <>
struct Choices<std::optional<FrictionLaw>> {
  using E = FrictionLaw;
  static constexpr Choice<std::optional<E>> all[] = {
      {E::Frictionless, "Frictionless"}, {E::Tresca, "Tresca"}, {E::Coulomb, "Coulomb"}, {std::nullopt, "Tied"}};
};

/// \brief How MPGP continues where a conjugate gradient step would leave the set.
enum class Expansion {
  Automatic,    ///< as ProjectedCg, but leaves out trials for a while after they failed
  ProjectedCg,  ///< project the whole conjugate gradient step; the fixed step where the cost falls less than that
                ///< step is bound to achieve
  FixedStep     ///< from the boundary by the fixed step alphaBar along the free gradient
};
template <>
struct Choices<Expansion> {
  using E = Expansion;
  static constexpr Choice<E> all[] = {{E::Automatic, "Automatic"}, {E::ProjectedCg, "Projected CG"}, {E::FixedStep, "Fixed Step"}};
};

/// \brief Constants of MPGP, all dimensionless.
struct MpgpOptions {
  double gamma = 1.0;       ///< Gamma > 0 of the proportionality test
  double stepLength = 1.9;  ///< alphaBar ||H||, in (0, 2)
  Expansion expansion = Expansion::Automatic;
};

/// \brief Constants of SMALSE-M, all dimensionless.
struct SmalseOptions : MpgpOptions {
  double rhoFactor = 1.0;  ///< rho / ||A||
  double mFactor = 1.0;    ///< first M / rho of the inner test ||g^P|| <= min(M ||Q (x - x0)||, eta)
  double mFloor = 0.1;     ///< least M / rho
  double beta = 10.0;      ///< M is divided by it where the Lagrangian grew too little
  double etaFactor = 0.1;  ///< eta / ||b||
  double innerReduction = 0.5;  ///< an inner loop may also end at this fraction of its first ||g^P||; 0: never

  static const OptionTable<SmalseOptions>& table();
};

enum class SolverMethod { Automatic, Smalse, SubspaceNewton, Pcpg };
template <>
struct Choices<SolverMethod> {
  using E = SolverMethod;
  static constexpr Choice<E> all[] = {
      {E::Automatic, "Automatic"}, {E::Smalse, "SMALSE"}, {E::SubspaceNewton, "Subspace Newton"}, {E::Pcpg, "PCPG"}};
};

struct SolverOptions {
  SolverMethod method = SolverMethod::Automatic;
  double tolerance = 1e-6;  ///< of kkt
  int maximumMultiplications = 5000;
  int maximumRecycledPairs = 300;
  SmalseOptions smalse;

  static const OptionTable<SolverOptions>& table();  ///< without smalse, which has its own
};

struct OutputOptions {
  std::string file, summary;  ///< names of files; empty: not written

  static const OptionTable<OutputOptions>& table();
};

}  // namespace Haptos
