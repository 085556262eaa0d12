/* SPDX-License-Identifier: BSD-3-Clause */
/* A stranger's C program on an installed Haptos: two beams in contact with friction, as matrices of subdomains.
   Writes x y z ux uy uz of all nodes to the file that is its argument, and tries what must hold: status and message after each kind of mistake,
   the next call after it, two systems at once on different communicators, and that only what changed is done again. */
#include <haptos.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { M = 4, NX = 2 * M, NODES = (NX + 1) * (M + 1) * (M + 1), HALF = (M + 1) * (M + 1) * (M + 1), ROWS = 3 * HALF };

static const double h = 1.0 / M, steel[2] = {2.119e5, 0.277}, aluminium[2] = {6.9e4, 0.333};
#define SOLVER(name, type, value)                                                                                      \
  "<ParameterList name='Haptos'><ParameterList name='Solver'><Parameter name='" name "' type='" type "' value='" value \
  "'/></ParameterList></ParameterList>"
static const char* tight = SOLVER("Relative Tolerance", "double", "1e-11");
static int failures = 0, rank = 0, size = 1;

#define CHECK(condition)                                                     \
  do {                                                                       \
    if (!(condition)) {                                                      \
      fprintf(stderr, "rank %d, line %d: %s\n", rank, __LINE__, #condition); \
      ++failures;                                                            \
    }                                                                        \
  } while (0)

static int64_t id(int body, int i, int j, int k) { return 1000 * body + 7 + ((int64_t)k * (M + 1) + j) * (NX + 1) + i; }

/* Brick of the side h, nodes numbered by bits of x, y, z; 2 x 2 x 2 Gauss points. */
static void brick(const double material[2], double K[24][24]) {
  const double lame = material[0] * material[1] / ((1 + material[1]) * (1 - 2 * material[1])), shear = material[0] / (2 * (1 + material[1]));
  memset(K, 0, sizeof(double[24][24]));
  for (int p = 0; p < 8; ++p) {
    double d[8][3];
    for (int n = 0; n < 8; ++n)
      for (int a = 0; a < 3; ++a) {
        d[n][a] = (n >> a & 1 ? 1 : -1) / (4 * h);
        for (int b = 0; b < 3; ++b)
          if (b != a) d[n][a] *= 1 + (n >> b & 1 ? 1 : -1) * (p >> b & 1 ? 1 : -1) / sqrt(3.0);
      }
    for (int m = 0; m < 8; ++m)
      for (int n = 0; n < 8; ++n)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            double entry = lame * d[m][a] * d[n][b] + shear * d[m][b] * d[n][a];
            if (a == b) entry += shear * (d[m][0] * d[n][0] + d[m][1] * d[n][1] + d[m][2] * d[n][2]);
            K[3 * m + a][3 * n + b] += h * h * h / 8 * entry;
          }
  }
}

/* Every body is cut in two cubes of M x M x M bricks.  The matrix is kept dense here: zeros are entries too. */
typedef struct {
  int64_t nodes[HALF], row_starts[ROWS + 1];
  double coordinates[HALF][3];
  int columns[ROWS * ROWS];
  double values[ROWS * ROWS];
  haptos_subdomain view;
} cube;

static int local(int i, int j, int k) { return (k * (M + 1) + j) * (M + 1) + i; }

static cube* make_cube(int body, int half) {
  cube* c = calloc(1, sizeof(cube));
  double K[24][24];
  brick(body ? steel : aluminium, K);
  for (int k = 0; k <= M; ++k)
    for (int j = 0; j <= M; ++j)
      for (int i = 0; i <= M; ++i) {
        const int n = local(i, j, k);
        c->nodes[n] = id(body, M * half + i, j, k);
        c->coordinates[n][0] = (M * half + i) * h;
        c->coordinates[n][1] = j * h;
        c->coordinates[n][2] = k * h + body - 1;
        if (i == M || j == M || k == M) continue;
        for (int a = 0; a < 24; ++a)
          for (int b = 0; b < 24; ++b) {
            const int row = 3 * local(i + (a / 3 & 1), j + (a / 3 >> 1 & 1), k + (a / 3 >> 2)) + a % 3;
            const int column = 3 * local(i + (b / 3 & 1), j + (b / 3 >> 1 & 1), k + (b / 3 >> 2)) + b % 3;
            c->values[row * ROWS + ROWS - 1 - column] += K[a][b]; /* columns from the last to the first */
          }
      }
  for (int row = 0; row <= ROWS; ++row) c->row_starts[row] = (int64_t)row * ROWS;
  for (int e = 0; e < ROWS * ROWS; ++e) c->columns[e] = ROWS - 1 - e % ROWS;
  const haptos_subdomain view = {body, HALF, c->nodes, &c->coordinates[0][0], c->row_starts, c->columns, c->values, 0, NULL};
  c->view = view;
  return c;
}

static void add_supports(haptos_system* s) {
  static const double zeros[3] = {0, 0, 0};
  static const int xyz[3] = {0, 1, 2};
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k <= M; ++k)
      for (int j = 0; j <= M; ++j) {
        const int64_t node = id(body, 0, j, k), thrice[3] = {node, node, node};
        CHECK(haptos_prescribe(s, 3, thrice, xyz, zeros) == HAPTOS_OK);
      }
}

static void add_pairs(haptos_system* s, double gap) {
  for (int j = 0; j <= M; ++j)
    for (int i = 0; i <= NX; ++i) {
      const int64_t upper = id(1, i, j, 0), lower = id(0, i, j, M);
      const double normal[3] = {0, 0, -1};
      const haptos_pairs pair = {0, 1, &upper, NULL, &lower, NULL, normal, NULL, &gap, NULL};
      CHECK(haptos_add_pairs(s, &pair) == HAPTOS_OK);
    }
}

/* A quarter of the load of every face on each of its nodes: pressure 100 on top, traction (20, 20, 0) at the end.  Every rank brings its
   share of all of them. */
static void set_loads(haptos_system* s, double factor) {
  static int64_t nodes[4 * (NX * M + M * M)];
  static double forces[4 * (NX * M + M * M)][3];
  int count = 0;
  for (int j = 0; j < M; ++j)
    for (int i = 0; i < NX; ++i)
      for (int n = 0; n < 4; ++n, ++count) {
        nodes[count] = id(1, i + (n & 1), j + (n >> 1), M);
        forces[count][2] = -100 * h * h / 4 * factor;
      }
  for (int k = 0; k < M; ++k)
    for (int j = 0; j < M; ++j)
      for (int n = 0; n < 4; ++n, ++count) {
        nodes[count] = id(1, NX, j + (n & 1), k + (n >> 1));
        forces[count][0] = forces[count][1] = 20 * h * h / 4 * factor;
        forces[count][2] = 0;
      }
  CHECK(haptos_set_loads(s, count, nodes, &forces[0][0]) == HAPTOS_OK);
}

typedef struct {
  haptos_system* system;
  cube* cubes[4];
  int count, numbers[4];
} scene;

static const haptos_friction coulomb = {HAPTOS_COULOMB, {0.3, 0.15}, 0};

/* Cubes are dealt to the ranks of comm in turn; the rest is brought by its last rank. */
static scene pose(MPI_Comm comm, const char* parameters, double gap) {
  scene s = {NULL, {NULL}, 0, {0}};
  int here, ranks, interface;
  MPI_Comm_rank(comm, &here);
  MPI_Comm_size(comm, &ranks);
  CHECK(haptos_create(comm, parameters, &s.system) == HAPTOS_OK);
  for (int c = 0; c < 4; ++c)
    if (c % ranks == here) {
      s.cubes[s.count] = make_cube(c / 2, c % 2);
      CHECK(haptos_add_subdomain(s.system, &s.cubes[s.count]->view, &s.numbers[s.count]) == HAPTOS_OK);
      ++s.count;
    }
  CHECK(haptos_add_interface(s.system, "joint", &coulomb, &interface) == HAPTOS_OK && interface == 0);
  set_loads(s.system, 1.0 / ranks);
  if (here != ranks - 1) return s;
  add_supports(s.system);
  add_pairs(s.system, gap);
  return s;
}

static void drop(scene* s) {
  for (int c = 0; c < s->count; ++c) free(s->cubes[c]);
  CHECK(haptos_destroy(&s->system) == HAPTOS_OK && s->system == NULL);
}

static double field[2 * NODES][3];

static void read_field(haptos_system* s, double u[2 * NODES][3]) {
  static int64_t nodes[2 * NODES];
  int n = 0;
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k <= M; ++k)
      for (int j = 0; j <= M; ++j)
        for (int i = 0; i <= NX; ++i) nodes[n++] = id(body, i, j, k);
  CHECK(haptos_displacements(s, n, nodes, &u[0][0]) == HAPTOS_OK);
}

/* Largest difference between the field of now and factor x u, relative to u. */
static double differs(haptos_system* s, double u[2 * NODES][3], double factor) {
  static double now[2 * NODES][3];
  double worst = 0, largest = 0;
  read_field(s, now);
  for (int n = 0; n < 2 * NODES; ++n)
    for (int d = 0; d < 3; ++d) {
      worst = fmax(worst, fabs(now[n][d] - factor * u[n][d]));
      largest = fmax(largest, fabs(factor * u[n][d]));
    }
  return worst / largest;
}

static void write_field(const char* file) {
  FILE* out = fopen(file, "w");
  int n = 0;
  for (int body = 0; body < 2; ++body)
    for (int k = 0; k <= M; ++k)
      for (int j = 0; j <= M; ++j)
        for (int i = 0; i <= NX; ++i, ++n)
          fprintf(out, "%.17g %.17g %.17g %.17g %.17g %.17g\n", i * h, j * h, k * h + body - 1, field[n][0], field[n][1], field[n][2]);
  fclose(out);
}

static int says(const haptos_system* s, const char* part) {
  if (strstr(haptos_message(s), part)) return 1;
  fprintf(stderr, "'%s' is not in '%s'\n", part, haptos_message(s));
  return 0;
}

static haptos_outcome solve(haptos_system* s) {
  haptos_outcome outcome;
  CHECK(haptos_solve(s, &outcome) == HAPTOS_OK && outcome.solved && outcome.residual <= 1e-11 && says(s, ""));
  return outcome;
}

/* What changes, and what is done again. */
static void try_changes(scene* s) {
  haptos_counters before, after;
  int pair = 0;
  double gap = 1e-3;
  const haptos_friction weak = {HAPTOS_COULOMB, {0.05, 0.02}, 0};
  CHECK(haptos_count(s->system, &before) == HAPTOS_OK && before.factorizations > 0 && before.rows > 0);
  set_loads(s->system, 2.0 / size); /* all is homogeneous */
  solve(s->system);
  CHECK(differs(s->system, field, 2) < 1e-8);
  set_loads(s->system, 1.0 / size);
  if (rank == size - 1) {
    for (pair = 0; pair < (NX + 1) * (M + 1); ++pair)
      if (pair % (NX + 1)) CHECK(haptos_set_gaps(s->system, 1, &pair, &gap) == HAPTOS_OK); /* where nothing is held */
  }
  solve(s->system);
  CHECK(differs(s->system, field, 1) > 1e-3);
  if (rank == size - 1) {
    gap = 0;
    for (pair = 0; pair < (NX + 1) * (M + 1); ++pair) CHECK(haptos_set_gaps(s->system, 1, &pair, &gap) == HAPTOS_OK);
  }
  CHECK(haptos_set_friction(s->system, 0, &weak) == HAPTOS_OK);
  solve(s->system);
  CHECK(differs(s->system, field, 1) > 1e-4);
  CHECK(haptos_set_friction(s->system, 0, &coulomb) == HAPTOS_OK);
  solve(s->system);
  CHECK(differs(s->system, field, 1) < 1e-8);
  CHECK(haptos_count(s->system, &after) == HAPTOS_OK && after.factorizations == before.factorizations && after.rows == before.rows);
  for (int c = 0; c < s->count; ++c) {
    for (int e = 0; e < ROWS * ROWS; ++e) s->cubes[c]->values[e] *= 4;
    CHECK(haptos_set_stiffness(s->system, s->numbers[c], s->cubes[c]->values) == HAPTOS_OK);
  }
  CHECK(solve(s->system).multiplications < before.multiplications); /* it starts from the multipliers, which are the same */
  CHECK(differs(s->system, field, 0.25) < 1e-8);
  CHECK(haptos_count(s->system, &after) == HAPTOS_OK && after.factorizations == 2 * before.factorizations);
}

/* Every kind of mistake, made by one rank, and the call after it. */
static void try_mistakes(scene* s) {
  haptos_system* none = NULL;
  haptos_outcome outcome;
  const double normal[3] = {0, 0, -1}, nan3[3] = {0, 0, NAN};
  const int64_t nowhere = 999999, somewhere = id(1, NX, 0, M);
  const haptos_pairs pair = {0, 1, &nowhere, NULL, NULL, NULL, normal, NULL, NULL, NULL};
  CHECK(haptos_create(MPI_COMM_WORLD, SOLVER("Relative Tolerence", "double", "1"), &none) == HAPTOS_INPUT_ERROR);
  CHECK(none == NULL && says(NULL, "Relative Tolerance"));
  CHECK(haptos_create(MPI_COMM_WORLD, "<Parameter", &none) == HAPTOS_INPUT_ERROR && says(NULL, "XML"));
  CHECK(haptos_create(MPI_COMM_NULL, NULL, &none) == HAPTOS_INPUT_ERROR && says(NULL, "MPI_COMM_NULL"));
  CHECK(haptos_set_up(NULL) == HAPTOS_INPUT_ERROR);
  if (rank == 0) CHECK(haptos_add_pairs(s->system, &pair) == HAPTOS_OK); /* told by the next collective call, to all */
  CHECK(haptos_solve(s->system, &outcome) == HAPTOS_INPUT_ERROR && !outcome.solved && says(s->system, "999999"));
  CHECK(haptos_clear_pairs(s->system) == HAPTOS_OK);
  if (rank == size - 1) add_pairs(s->system, 0);
  if (rank == 0) haptos_set_gaps(s->system, 1, &failures, NULL);
  CHECK(haptos_set_up(s->system) == HAPTOS_INPUT_ERROR && says(s->system, "Gaps"));
  if (rank == size - 1) haptos_set_loads(s->system, 1, &somewhere, nan3);
  CHECK(haptos_solve(s->system, NULL) == HAPTOS_INPUT_ERROR && says(s->system, "not finite"));
  if (rank == size - 1) haptos_set_loads(s->system, 1, &nowhere, normal);
  CHECK(haptos_solve(s->system, NULL) == HAPTOS_INPUT_ERROR && says(s->system, "999999"));
  set_loads(s->system, 1.0 / size);
  solve(s->system);
  CHECK(differs(s->system, field, 1) < 1e-9);
}

/* One rank's; all hear of it, and the call after it works. */
static void refused(haptos_system* s, const char* text) {
  CHECK(haptos_set_up(s) == HAPTOS_INPUT_ERROR && says(s, text) && haptos_set_up(s) == HAPTOS_OK);
}

/* Counts and arrays of one rank that do not fit: of functions that write values, and of those that take them. */
static void try_arguments(scene* s) {
  static double forces[(NX + 1) * (M + 1)][3];
  double u[3] = {0, 0, 0};
  const int64_t node = id(1, NX, 0, M);
  const int last = rank == size - 1, zero = 0; /* it has the pairs */
  int64_t count = 0;
  CHECK(haptos_displacements(s->system, last ? -1 : 0, NULL, NULL) == HAPTOS_INPUT_ERROR && says(s->system, "count -1"));
  CHECK(haptos_displacements(s->system, last, &node, last ? NULL : u) == HAPTOS_INPUT_ERROR && says(s->system, "NULL"));
  CHECK(haptos_displacements(s->system, last, last ? NULL : &node, u) == HAPTOS_INPUT_ERROR && says(s->system, "NULL"));
  CHECK(haptos_displacements(s->system, last, &node, u) == HAPTOS_OK && (fabs(u[2]) > 0) == last);
  CHECK(haptos_contact_forces(s->system, NULL) == HAPTOS_INPUT_ERROR && says(s->system, "45 pairs"));
  CHECK(haptos_contact_forces(s->system, last ? &forces[0][0] : NULL) == HAPTOS_OK && (forces[NX][0] > 0) == last);
  CHECK(haptos_multipliers(s->system, NULL, NULL) == HAPTOS_INPUT_ERROR && says(s->system, "NULL"));
  CHECK(haptos_multipliers(s->system, &count, NULL) == HAPTOS_OK);
  if (rank == 0) CHECK(haptos_set_gaps(s->system, -1, &zero, u) == HAPTOS_OK);
  refused(s->system, "Gaps come with the count -1");
  if (rank == 0) CHECK(haptos_set_loads(s->system, -2, &node, u) == HAPTOS_OK);
  refused(s->system, "Loads come with the count -2");
  if (rank == 0) CHECK(haptos_prescribe(s->system, -3, &node, &zero, u) == HAPTOS_OK);
  refused(s->system, "Prescribed displacements come with the count -3");
  if (rank == 0) CHECK(haptos_add_nodes(s->system, -4, &node, u) == HAPTOS_OK);
  refused(s->system, "Nodes come with the count -4");
  if (rank == 0) CHECK(haptos_add_elements(s->system, 0, -5, 8, &node, u) == HAPTOS_OK);
  refused(s->system, "Elements come with the count -5");
  if (rank == 0) CHECK(haptos_set_elements(s->system, 0, -6, u) == HAPTOS_OK);
  refused(s->system, "Elements come with the count -6");
}

/* Pairs of the upper beam's end: none of those that are refused may become a rigid obstacle. */
static void try_starts(scene* s) {
  const int64_t secondary[2] = {id(1, NX, 0, M), id(1, NX, 1, M)}, primary[2] = {id(0, NX, 0, M), id(0, NX, 1, M)};
  const int64_t wrong[4][3] = {{0, 2, 1}, {1, 1, 2}, {-1, 0, 1}, {0, 0, 2}};
  const char* text[4] = {"begin with 0 and not fall", "begin with 0 and not fall", "begin with 0 and not fall", "Pair 0"};
  const double normals[6] = {1, 0, 0, 1, 0, 0};
  haptos_pairs pairs = {0, 2, secondary, NULL, primary, NULL, normals, NULL, NULL, NULL};
  for (int w = 0; w < 4; ++w) {
    pairs.primary_starts = wrong[w];
    if (rank == 0) CHECK(haptos_add_pairs(s->system, &pairs) == HAPTOS_OK);
    refused(s->system, text[w]);
  }
  pairs.primary = NULL;
  if (rank == 0) CHECK(haptos_add_pairs(s->system, &pairs) == HAPTOS_OK);
  refused(s->system, "primary is NULL");
  pairs.count = -1;
  if (rank == 0) CHECK(haptos_add_pairs(s->system, &pairs) == HAPTOS_OK);
  refused(s->system, "Pairs come with the count -1");
  solve(s->system);
  CHECK(differs(s->system, field, 1) < 1e-9);
}

/* What is refused has no number, and what comes after it is numbered as if it had not been there. */
static void try_numbers(void) {
  haptos_system *s, *cut;
  cube* c = make_cube(0, 0);
  const haptos_friction unknown = {9, {0, 0}, 0};
  double K[3][24][24];
  int64_t nodes[3][8];
  int number = 7;
  CHECK(haptos_create(MPI_COMM_SELF, NULL, &s) == HAPTOS_OK && haptos_create(MPI_COMM_SELF, NULL, &cut) == HAPTOS_OK);
  CHECK(haptos_add_interface(s, "a", &unknown, &number) == HAPTOS_OK && number == -1);
  CHECK(haptos_set_up(s) == HAPTOS_INPUT_ERROR && says(s, "laws are 0"));
  CHECK(haptos_add_interface(s, "a", &coulomb, &number) == HAPTOS_OK && number == 0);
  c->view.kernel_columns = 6;
  CHECK(haptos_add_subdomain(s, &c->view, &number) == HAPTOS_OK && number == -1);
  CHECK(haptos_set_up(s) == HAPTOS_INPUT_ERROR && says(s, "kernel"));
  c->view.kernel_columns = 0;
  c->nodes[1] = c->nodes[0];
  CHECK(haptos_add_subdomain(s, &c->view, &number) == HAPTOS_OK && number == -1);
  CHECK(haptos_set_up(s) == HAPTOS_INPUT_ERROR && says(s, "twice"));
  c->nodes[1] = id(0, 1, 0, 0);
  CHECK(haptos_add_subdomain(s, &c->view, &number) == HAPTOS_OK && number == 0 && haptos_set_up(s) == HAPTOS_OK);
  CHECK(haptos_set_stiffness(s, 0, c->values) == HAPTOS_OK && haptos_set_up(s) == HAPTOS_OK);
  CHECK(haptos_set_stiffness(s, 1, c->values) == HAPTOS_OK);
  refused(s, "this rank added 1,");
  for (int e = 0; e < 3; ++e) {
    brick(steel, K[e]);
    for (int n = 0; n < 8; ++n) nodes[e][n] = e == 1 ? 999999 : id(0, e / 2 + (n & 1), n >> 1 & 1, n >> 2);
  }
  CHECK(haptos_add_nodes(cut, HALF, c->nodes, &c->coordinates[0][0]) == HAPTOS_OK);
  CHECK(haptos_add_elements(cut, 0, 3, 8, &nodes[0][0], &K[0][0][0]) == HAPTOS_OK); /* the second has no place, the others stay */
  CHECK(haptos_set_up(cut) == HAPTOS_INPUT_ERROR && says(cut, "999999") && haptos_set_up(cut) == HAPTOS_OK);
  CHECK(haptos_set_elements(cut, 0, 2, &K[0][0][0]) == HAPTOS_OK && haptos_set_up(cut) == HAPTOS_OK);
  CHECK(haptos_set_elements(cut, 1, 2, &K[0][0][0]) == HAPTOS_OK);
  refused(cut, "this rank added 2,");
  CHECK(haptos_destroy(&s) == HAPTOS_OK && haptos_destroy(&cut) == HAPTOS_OK);
  free(c);
}

/* A limit that is hit; a body that nothing holds. */
static void try_other_ends(void) {
  haptos_system* s;
  haptos_outcome outcome;
  cube* c = make_cube(0, 0);
  const int64_t corner = id(0, 0, 0, 0);
  int64_t count = 0;
  const double force[3] = {1, 0, 0};
  CHECK(haptos_create(MPI_COMM_WORLD, NULL, &s) == HAPTOS_OK);
  if (rank == 0) CHECK(haptos_add_subdomain(s, &c->view, NULL) == HAPTOS_OK);
  CHECK(haptos_displacements(s, 0, NULL, NULL) == HAPTOS_INPUT_ERROR && says(s, "haptos_solve"));
  CHECK(haptos_multipliers(s, &count, NULL) == HAPTOS_INPUT_ERROR && says(s, "haptos_solve"));
  if (rank == 0) haptos_set_loads(s, 1, &corner, force);
  CHECK(haptos_solve(s, &outcome) == HAPTOS_NO_SOLUTION && strlen(haptos_message(s)) > 20);
  CHECK(haptos_destroy(&s) == HAPTOS_OK);
  free(c);
  scene full = pose(MPI_COMM_WORLD, SOLVER("Maximum Hessian Multiplications", "int", "3"), 0);
  CHECK(haptos_solve(full.system, &outcome) == HAPTOS_NOT_CONVERGED && !outcome.solved && strlen(outcome.reason) > 0 && says(full.system, "Maximum Hessian Multiplications"));
  CHECK(differs(full.system, field, 1) > 1e-6);
  drop(&full);
}

int main(int argc, char** argv) {
  MPI_Comm half;
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  scene whole = pose(MPI_COMM_WORLD, tight, 0);
  const haptos_outcome outcome = solve(whole.system);
  read_field(whole.system, field);

  MPI_Comm_split(MPI_COMM_WORLD, rank % 2, rank, &half); /* two systems at once, one of them on a part of the ranks */
  scene part = pose(half, tight, rank % 2 ? 1e-3 : 0);
  solve(part.system);
  CHECK(rank % 2 || differs(part.system, field, 1) < 1e-9);
  CHECK(rank % 2 == 0 || part.count == 4);
  solve(whole.system);
  CHECK(differs(whole.system, field, 1) < 1e-9);
  drop(&part);
  MPI_Comm_free(&half);

  try_mistakes(&whole);
  try_arguments(&whole);
  try_starts(&whole);
  try_numbers();
  try_changes(&whole);
  try_other_ends();
  drop(&whole);
  MPI_Allreduce(MPI_IN_PLACE, &failures, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  if (rank == 0 && argc > 1) write_field(argv[1]);
  if (rank == 0) printf("%s on %d ranks: %ld multiplications by %s, %d failures\n", argv[0], size, (long)outcome.multiplications, outcome.method, failures);
  MPI_Finalize();
  return failures != 0;
}
