/* SPDX-License-Identifier: BSD-3-Clause */
/* Haptos from C: bodies in contact with friction, for programs that assemble by themselves.

     minimise 1/2 u^T K u - f^T u   with contact and friction on pairs of nodes, u = prescribed where it is

   A system takes stiffnesses, pairs and loads, and is solved again and again; what is given after a solve changes the next one,
   and only what it touches is done again (loads: next to nothing; gaps: a right-hand side; friction: laws; pairs: rows;
   stiffness: factors; the multipliers are where the next solve starts).

   Functions return a status, haptos_message() tells what was wrong.  Nothing is printed, no exception leaves, MPI is never
   aborted.  A system has a communicator of its own: several may be alive at once, on any communicators.

   Collective functions are called by all ranks of the system's communicator and return the same status on all of them, also where
   the arguments of one rank alone are wrong.  The others are Local: they copy what they are given, and return 0 also where
   something is wrong with it, as a rank that turned back alone would leave the others waiting.  All ranks are told by the next
   collective function, at the latest by the next haptos_set_up or haptos_solve, once; it does nothing else.  What then is to be
   given again:

     refused by the function that was given it (NULL, a count < 0, a number or a component that is nowhere, a subdomain that has a
     node twice, an element whose node has no place): it was not taken.  Give it again, and nothing else.  Of several mistakes the
     first of the lowest rank is told; none of them was taken.

     refused by set-up, which looks at matrices, pairs and prescribed values as a whole (a matrix that is not symmetric, or is
     definite, or has another kernel; an id in two bodies; a pair or a prescribed value at a node that is in no subdomain): it
     stays, and every set-up refuses it anew, until pairs are cleared (haptos_clear_pairs) or prescribed values are
     (haptos_clear_prescribed) and given again.  For another matrix or other nodes make a new system.  Loads, gaps and friction
     need only be set again.

   Nodes are numbered as the caller likes (ids from 0 to 2^63 / 3, not necessarily without gaps).  An id is of one body: in several subdomains
   or elements of that body it is the same material point, in two bodies it is refused.  Bodies and all other numbers count from
   0.  Units are the caller's.

   The contact law and its signs: [u] = u_secondary - sum of weight x u_primary, [u].n <= gap; the force on the secondary node is
   -(N n + T1 t1 + T2 t2), N >= 0, and (T1/F1)^2 + (T2/F2)^2 <= N^2 (Coulomb) or (slip bound x area)^2 (Tresca).  t1 is the axis
   of the pair projected on the plane orthogonal to n; an axis within 0.1 degrees of n or -n is replaced by x, and where x is
   there, too, by z; t2 = n x t1.  Friction resists the total slip from the state without loads to that of this solve: no solve
   remembers the slip of the one before. */
#ifndef HAPTOS_H
#define HAPTOS_H

#include <mpi.h>
#include <stdint.h>

#define HAPTOS_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

typedef struct haptos_system haptos_system;

enum haptos_status {
  HAPTOS_OK = 0,
  HAPTOS_INPUT_ERROR = 1,    /* what was given is wrong: the message says what, and what would be right */
  HAPTOS_NOT_CONVERGED = 2,  /* displacements and forces are there, but their error is above Relative Tolerance */
  HAPTOS_NO_SOLUTION = 3,    /* a body that nothing holds under load, or data that contradict each other */
  HAPTOS_INTERNAL_ERROR = 70 /* ours, or the system's (out of memory) */
};

enum haptos_law { HAPTOS_FRICTIONLESS = 0, HAPTOS_TRESCA = 1, HAPTOS_COULOMB = 2, HAPTOS_TIED = 3 };

typedef struct haptos_friction {
  int law;                /* enum haptos_law */
  double coefficients[2]; /* F1, F2 [-] along the principal axes */
  double slip_bound;      /* Tresca: traction [force/area] */
} haptos_friction;

/* A part of a body with the stiffness that it has by itself: nothing held, nothing merged with others (Neumann).  Rows are
   3 x node + component with nodes as they are listed; CSR, all entries (both triangles), columns in any order. */
typedef struct haptos_subdomain {
  int body;
  int num_nodes;
  const int64_t* nodes;       /* [num_nodes] ids */
  const double* coordinates;  /* [num_nodes][3] */
  const int64_t* row_starts;  /* [3 num_nodes + 1] */
  const int* columns;         /* [row_starts[3 num_nodes]] */
  const double* values;       /* the same */
  int kernel_columns;         /* 0: rigid motions that cost no energy are found by themselves */
  const double* kernel;       /* [kernel_columns][3 num_nodes]: all that the matrix does not feel, or NULL */
} haptos_subdomain;

/* Nodes of a secondary side and what they may touch: better of the softer side than of one that is far stiffer, and not of one
   whose nodes are held and more than those opposite. */
typedef struct haptos_pairs {
  int interface;                 /* from haptos_add_interface */
  int count;
  const int64_t* secondary;      /* [count] ids */
  const int64_t* primary_starts; /* [count + 1] first primary node of each pair: from 0 on, rising; NULL: one each */
  const int64_t* primary;        /* [primary_starts[count]] ids; NULL: a rigid obstacle for all, primary_starts NULL or all 0 */
  const double* weights;         /* the same; they add up to 1 for every pair; NULL: equal */
  const double* normals;         /* [count][3] outward from the secondary side */
  const double* axes;            /* [count][3] first principal axis of friction, see above; not 0; NULL: global x */
  const double* gaps;            /* [count] [length]; NULL: 0; more than a million times the model counts as that; of no effect on ties */
  const double* areas;           /* [count] [area] of the nodes, for Tresca's law; NULL: 1 */
} haptos_pairs;

typedef struct haptos_outcome {
  int solved;              /* 1: residual <= Relative Tolerance */
  int64_t multiplications; /* by the dual operator F = B K^+ B^T, for this solve */
  double residual;         /* [-] largest relative error of equilibrium, continuity and contact laws */
  char method[64];
  char reason[512];        /* why it is not solved; cut where it is longer, see haptos_message */
} haptos_outcome;

typedef struct haptos_counters { /* work since the system was made, over all ranks */
  int64_t factorizations;  /* of subdomain matrices; congruent ones share theirs */
  int64_t multiplications; /* by F */
  int64_t rows;            /* times that constraint rows were made */
} haptos_counters;

/* A system on a duplicate of comm.  Collective.
   parameters: XML as for the program, a list "Haptos" with any of the sublists Solver, Local Solver, Preconditioner, Coarse Problem,
   Decomposition (doc/input.md); rank 0's is taken; NULL: defaults.  *system is NULL where the status is not 0. */
HAPTOS_API int haptos_create(MPI_Comm comm, const char* parameters, haptos_system** system);
/* The same for a communicator of Fortran (also mpi4py's comm.py2f()). */
HAPTOS_API int haptos_create_fortran(MPI_Fint comm, const char* parameters, haptos_system** system);
/* The same on this process alone; starts MPI where nobody did, and then ends it when the program ends. */
HAPTOS_API int haptos_create_serial(const char* parameters, haptos_system** system);
/* Collective; before MPI_Finalize.  Sets *system to NULL. */
HAPTOS_API int haptos_destroy(haptos_system** system);

/* What the last function that did not return 0 found, or why the last solve is not converged; "" where all is well.  Valid until
   the next call with the system.  NULL: of this thread's last haptos_create. */
HAPTOS_API const char* haptos_message(const haptos_system* system);

/* --- what is solved: Local, but for interfaces, which all ranks add alike and in the same order --- */

/* *interface is its number, -1 where it is refused; may be NULL. */
HAPTOS_API int haptos_add_interface(haptos_system* system, const char* name, const haptos_friction* friction, int* interface);
/* Before set-up.  *number counts the subdomains of this rank that were taken, -1 where this one is refused; may be NULL. */
HAPTOS_API int haptos_add_subdomain(haptos_system* system, const haptos_subdomain* subdomain, int* number);
/* Places of the nodes of elements that this rank adds; coordinates [count][3], finite.  All of them are taken or none. */
HAPTOS_API int haptos_add_nodes(haptos_system* system, int64_t count, const int64_t* nodes, const double* coordinates);
/* Instead of subdomains, before set-up: elements of one kind, each on one rank; the system cuts them into subdomains.  nodes
   [count][nodes_per_element] ids, Ke [count][3 nodes_per_element][3 nodes_per_element].  Every element is looked at by itself:
   one is refused for a node < 0 or without a place on this rank, all are for a body < 0 or after set-up, and none is taken where
   an argument is wrong (NULL, count < 0, nodes_per_element < 1).  Where some are refused the others stay, those before and those
   after them: give the missing ones again, not all.  Elements of a rank are numbered in the order in which they are taken; a
   refused one has no number, and those after it move up. */
HAPTOS_API int haptos_add_elements(haptos_system* system, int body, int64_t count, int nodes_per_element, const int64_t* nodes,
                                   const double* Ke);
/* u_component(node) = value, for count of them; once more after a solve: another value.  Where some are refused (a component that is
   not 0, 1 or 2, a value that is not finite) the others stay. */
HAPTOS_API int haptos_prescribe(haptos_system* system, int64_t count, const int64_t* nodes, const int* components, const double* values);
HAPTOS_API int haptos_clear_prescribed(haptos_system* system); /* all that this rank prescribed */
/* All of them are taken or none.  Pairs of a rank are numbered in the order in which they are added. */
HAPTOS_API int haptos_add_pairs(haptos_system* system, const haptos_pairs* pairs);
HAPTOS_API int haptos_clear_pairs(haptos_system* system); /* of this rank; numbers begin with 0 again */

/* --- what changes from solve to solve: Local --- */

/* Forces [count][3] on nodes, instead of all that this rank gave before; a node may be named more than once, by any ranks: its
   forces add up. */
HAPTOS_API int haptos_set_loads(haptos_system* system, int64_t count, const int64_t* nodes, const double* forces);
/* gaps [count] [length] of this rank's pairs [count], by number.  Where some are refused (a number that is nowhere) the others stay. */
HAPTOS_API int haptos_set_gaps(haptos_system* system, int count, const int* pairs, const double* gaps);
HAPTOS_API int haptos_set_friction(haptos_system* system, int interface, const haptos_friction* friction); /* all ranks alike */
/* Other entries for one of this rank's subdomains, in the order of its CSR columns. */
HAPTOS_API int haptos_set_stiffness(haptos_system* system, int subdomain, const double* values);
/* Other matrices for count of this rank's elements from number first on. */
HAPTOS_API int haptos_set_elements(haptos_system* system, int64_t first, int64_t count, const double* Ke);

/* --- solving: Collective --- */

/* Cuts, checks and numbers what was given; haptos_solve does it where it was not done. */
HAPTOS_API int haptos_set_up(haptos_system* system);
/* outcome may be NULL. */
HAPTOS_API int haptos_solve(haptos_system* system, haptos_outcome* outcome);

/* Displacements u [count][3] of any nodes [count], after a solve.  Collective; ranks may ask for different nodes, or none. */
HAPTOS_API int haptos_displacements(haptos_system* system, int64_t count, const int64_t* nodes, double* u);
/* (N, T1, T2) of the pairs that this rank added, forces [pairs][3], after a solve and before pairs, supports or kinds of laws change.
   Collective; a rank without pairs may give NULL. */
HAPTOS_API int haptos_contact_forces(haptos_system* system, double* forces);
/* All multipliers that this rank has (contact forces, gluing forces, reactions) by row: how many, and where values is not NULL
   the values.  Local, after a solve; before one it returns HAPTOS_INPUT_ERROR at once. */
HAPTOS_API int haptos_multipliers(haptos_system* system, int64_t* count, double* values);
HAPTOS_API int haptos_count(haptos_system* system, haptos_counters* counters); /* Collective */

#ifdef __cplusplus
}
#endif
#endif
