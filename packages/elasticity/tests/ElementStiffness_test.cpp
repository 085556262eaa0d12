// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <limits>

#include "DenseAlgebra.hpp"
#include "ElasticityFixtures.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Matrix24 = ElementStiffness<Hex8Shape>;

const std::array<Formulation, 2> formulations{Formulation::Standard, Formulation::BBar};

Matrix24 hexStiffness(const Solid& solid, const ElasticModuli& moduli, Formulation formulation) {
  Matrix24 k;
  elementStiffness<Hex8Shape>(elementGradients<Hex8Shape>(solid.coordinates, solid.groups[0], 0), moduli,
                              formulation, k);
  return k;
}

// Closed form on a brick of edges h: products of the one-dimensional integrals of N_a N_b, N_a' N_b and N_a'
// N_b'.
Matrix24 brickStiffness(std::array<double, 3> h, const ElasticModuli& m, Formulation formulation) {
  const int end[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const auto sign = [](int e) { return e == 0 ? -1.0 : 1.0; };
  const double volume = h[0] * h[1] * h[2];
  Matrix24 k;
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b) {
      Eigen::Matrix3d g;  // integral of dN_a/dx_i dN_b/dx_j
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          g(i, j) = 1.0;
          for (int c = 0; c < 3; ++c) {
            const int ea = end[a][c], eb = end[b][c];
            if (c == i && c == j)
              g(i, j) *= sign(ea) * sign(eb) / h[c];
            else if (c == i)
              g(i, j) *= 0.5 * sign(ea);
            else if (c == j)
              g(i, j) *= 0.5 * sign(eb);
            else
              g(i, j) *= h[c] * (ea == eb ? 1.0 / 3.0 : 1.0 / 6.0);
          }
        }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          double divDiv = m.lambda * g(i, j);
          if (formulation == Formulation::BBar)  // mean of dN_a/dx_i is +- 1/(4 h_i)
            divDiv = m.bulk * volume * sign(end[a][i]) * sign(end[b][j]) / (16.0 * h[i] * h[j]) -
                     2.0 / 3.0 * m.shear * g(i, j);
          k(3 * a + i, 3 * b + j) = divDiv + m.shear * (g(j, i) + (i == j ? g.trace() : 0.0));
        }
    }
  return k;
}

template <class Matrix>
void checkSixZeroEigenvalues(const Matrix& k, double smallestStrain, Teuchos::FancyOStream& out,
                             bool& success) {
  const Eigen::VectorXd values = Testing::symmetricEigenvalues(k);
  const double largest = values(values.size() - 1);
  TEST_ASSERT(values.head(6).cwiseAbs().maxCoeff() < 1e-14 * largest * double(values.size()));
  TEST_ASSERT(values(6) > smallestStrain * largest);
  out << "seventh eigenvalue " << values(6) / largest << " of the largest\n";
}

TEUCHOS_UNIT_TEST(ElementStiffness, BrickEqualsClosedForm) {
  for (const auto formulation : formulations)
    for (const auto& h :
         {std::array<double, 3>{1, 1, 1}, {0.5, 2.0, 3.0}, {100.0, 1.0, 1.0}, {1.0, 1.0, 1e-2}})
      for (const double nu : {-0.5, 0.0, 0.3, 0.4999}) {
        const auto moduli = elasticModuli({"m", 2.1e5, nu});
        const Matrix24 expected = brickStiffness(h, moduli, formulation);
        const Matrix24 k = hexStiffness(brick(h), moduli, formulation);
        TEST_ASSERT((k - expected).cwiseAbs().maxCoeff() < 2e-14 * expected.cwiseAbs().maxCoeff());
      }
}

// Own references, twelve digits, from an independent implementation (edge 0.25, E = 6.9e4).
TEUCHOS_UNIT_TEST(ElementStiffness, CubeEqualsIndependentNumbers) {
  const auto solid = brick({0.25, 0.25, 0.25});
  struct Reference {
    Formulation formulation;
    double nu;
    double k00, k06, k33, norm;
  };
  for (const auto& r :
       {Reference{Formulation::Standard, 0.333, 4309.27342614, -1077.31835654, 4309.27342614, 33358.6614115},
        Reference{Formulation::BBar, 0.333, 3472.40549534, -1675.08116425, 3472.40549534, 30700.2316073},
        Reference{Formulation::BBar, 0.499, 181818.55033, -180220.262582, 181818.55033, 4312525.27367}}) {
    const Matrix24 k = hexStiffness(solid, elasticModuli({"m", 6.9e4, r.nu}), r.formulation);
    TEST_FLOATING_EQUALITY(k(0, 0), r.k00, 1e-11);
    TEST_FLOATING_EQUALITY(k(0, 18), r.k06, 1e-11);
    TEST_FLOATING_EQUALITY(k(3, 3), r.k33, 1e-11);
    TEST_FLOATING_EQUALITY(k.norm(), r.norm, 1e-11);
  }
}

TEUCHOS_UNIT_TEST(ElementStiffness, SymmetricWithSixRigidMotions) {
  const auto moduli = elasticModuli(steel()[0]);
  for (const auto& solid : {brick({1, 1, 1}), distortedHex()}) {
    const Eigen::MatrixXd R = rigidBodyModes(solid.coordinates);
    for (const auto formulation : formulations) {
      const Matrix24 k = hexStiffness(solid, moduli, formulation);
      TEST_EQUALITY((k - k.transpose()).cwiseAbs().maxCoeff(), 0.0);
      TEST_ASSERT((k * R).cwiseAbs().maxCoeff() < 1e-14 * k.norm());
      checkSixZeroEigenvalues(k, 1e-2, out, success);
    }
  }
  const auto tets = makeSolid(Topology::Tet4, {1, 1, 1});
  ElementStiffness<Tet4Shape> k;
  elementStiffness<Tet4Shape>(elementGradients<Tet4Shape>(tets.coordinates, tets.groups[0], 3), moduli,
                              Formulation::Standard, k);
  TEST_EQUALITY((k - k.transpose()).cwiseAbs().maxCoeff(), 0.0);
  checkSixZeroEigenvalues(k, 1e-2, out, success);
}

TEUCHOS_UNIT_TEST(ElementStiffness, NeedlesAndPlatesKeepSixRigidMotions) {
  for (const auto& h : {std::array<double, 3>{100, 1, 1}, {1, 1, 0.01}})
    for (const auto formulation : formulations)
      checkSixZeroEigenvalues(hexStiffness(brick(h), elasticModuli(steel()[0]), formulation), 1e-9, out,
                              success);
}

TEUCHOS_UNIT_TEST(ElementStiffness, EnergyOfConstantStrainIsExact) {
  const auto moduli = elasticModuli(steel()[0]);
  const Eigen::Matrix3d H = someGradient(), eps = 0.5 * (H + H.transpose());
  const double density = moduli.shear * eps.squaredNorm() + 0.5 * moduli.lambda * eps.trace() * eps.trace();
  const auto solid = distortedHex();
  const auto volumes = elementGradients<Hex8Shape>(solid.coordinates, solid.groups[0], 0).volumes;
  TEST_ASSERT(volumes.maxCoeff() > 1.2 * volumes.minCoeff());  // it is distorted
  const Eigen::VectorXd u = linearField(solid.coordinates, H);
  for (const auto formulation : formulations)
    TEST_FLOATING_EQUALITY(0.5 * u.dot(hexStiffness(solid, moduli, formulation) * u), density * volumes.sum(),
                           1e-13);
}

TEUCHOS_UNIT_TEST(ElementStiffness, BBarSoftensDistortedHexNearIncompressibility) {
  const auto moduli = elasticModuli({"rubber", 1.0, 0.4999});
  const auto solid = distortedHex();
  const Matrix24 standard = hexStiffness(solid, moduli, Formulation::Standard);
  const Matrix24 bbar = hexStiffness(solid, moduli, Formulation::BBar);
  const auto count = [&](const Matrix24& k) {  // motions that resist like the bulk modulus
    const Eigen::VectorXd values = Testing::symmetricEigenvalues(k);
    return (values.array() > 5.0 * moduli.shear).count();
  };
  TEST_EQUALITY(count(bbar), 1);
  TEST_ASSERT(count(standard) >= 7);
}

TEUCHOS_UNIT_TEST(ElementStiffness, UnitOfLengthScalesOut) {
  const auto moduli = elasticModuli(steel()[0]);
  auto millimetres = distortedHex();
  const Matrix24 k = hexStiffness(millimetres, moduli, Formulation::BBar);
  for (auto& x : millimetres.coordinates)
    for (double& c : x) c *= 1e-3;
  const Matrix24 scaled = 1e3 * hexStiffness(millimetres, moduli, Formulation::BBar);
  TEST_ASSERT((k - scaled).cwiseAbs().maxCoeff() < 1e-14 * k.cwiseAbs().maxCoeff());
}

TEUCHOS_UNIT_TEST(ElementStiffness, ForceByStressEqualsStiffnessTimesDisplacement) {
  const auto moduli = elasticModuli(steel()[0]);
  const auto solid = distortedHex();
  const auto gradients = elementGradients<Hex8Shape>(solid.coordinates, solid.groups[0], 0);
  const ElementVector<Hex8Shape> u = someVector(24);
  for (const auto formulation : formulations) {
    const Matrix24 k = hexStiffness(solid, moduli, formulation);
    const ElementVector<Hex8Shape> force = elementForce<Hex8Shape>(gradients, moduli, formulation, u);
    TEST_ASSERT((force - k * u).norm() < 1e-14 * k.norm() * u.norm());
  }
}

std::string messageOf(const Solid& solid, int element) {
  try {
    if (solid.groups[0].topology == Topology::Hex8)
      elementGradients<Hex8Shape>(solid.coordinates, solid.groups[0], element);
    else
      elementGradients<Tet4Shape>(solid.coordinates, solid.groups[0], element);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEUCHOS_UNIT_TEST(ElementStiffness, BadElementsAreNamed) {
  auto mirrored = makeSolid(Topology::Hex8, {2, 1, 1});
  auto& nodes = mirrored.groups[0].connectivity;
  for (int a = 8; a < 12; ++a) std::swap(nodes[std::size_t(a)], nodes[std::size_t(a + 4)]);
  TEST_EQUALITY(messageOf(mirrored, 0), "");
  const auto message = messageOf(mirrored, 1);
  out << message << "\n";
  TEST_ASSERT(mentions(message, "element 1002 (HEX8) of block \"cube\" is inverted"));

  auto folded = makeSolid(Topology::Hex8, {1, 1, 1});
  folded.coordinates[7] = {0.4, 0.4, -0.9};
  out << messageOf(folded, 0) << "\n";
  TEST_ASSERT(mentions(messageOf(folded, 0), "element 1001 (HEX8) of block \"cube\" is folded"));

  auto flat = makeSolid(Topology::Tet4, {1, 1, 1});
  for (auto& x : flat.coordinates) x[2] = 0.1 * x[0] + 0.3 * x[1];
  out << messageOf(flat, 4) << "\n";
  TEST_ASSERT(mentions(messageOf(flat, 4), "element 1005 (TETRA4) of block \"cube\" is degenerate"));

  auto lost = makeSolid(Topology::Tet4, {1, 1, 1});
  lost.coordinates[6 + 1][1] = std::numeric_limits<double>::quiet_NaN();
  out << messageOf(lost, 0) << "\n";
  TEST_ASSERT(mentions(messageOf(lost, 0), "not finite"));
}

TEUCHOS_UNIT_TEST(ElementStiffness, BadMaterialsAreNamed) {
  for (const auto& [e, nu] : {std::pair<double, double>{0.0, 0.3},
                              {-1.0, 0.3},
                              {1.0, 0.5},
                              {1.0, -1.0},
                              {std::nan(""), 0.3},
                              {1.0, std::nan("")},
                              {HUGE_VAL, 0.3}})
    TEST_THROW(elasticModuli({"bad", e, nu}), InputError);
}

}  // namespace
