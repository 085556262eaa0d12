// SPDX-License-Identifier: BSD-3-Clause
// Mesh and Materials.
#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include "Haptos_ParameterSections.hpp"

namespace Haptos {

using Teuchos::ParameterList;
using Type = ParameterType;

ParameterTree meshSection() {
  ParameterTree twoBeams(
      "Two Beams",
      "A generated benchmark: lower body x in [0,2], y in [0,1], z in [-1,0], upper body z in "
      "[0,1]. Element blocks `lower`, `upper`; side sets `lower_contact` (z=0), `upper_contact` "
      "(z=0), `lower_clamp` and `upper_clamp` (x=0), `upper_top` (z=1), `lower_bottom` (z=-1), "
      "`upper_end` (x=2).");
  twoBeams
      .add(ParameterSpec("Subdomains Per Edge", {Type::Int}, "k: each body has 2k x k x k bricks")
               .mustBeGiven()
               .within(NumberRange::closed(1, 200)))
      .add(ParameterSpec("Elements Per Subdomain Edge", {Type::Int},
                         "p = H/h: each brick has p x p x p elements")
               .mustBeGiven()
               .within(NumberRange::closed(1, 200)));
  ParameterTree mesh("Mesh", "The bodies: a file or a generated mesh.");
  mesh.add(ParameterSpec("File", {Type::String}, "Exodus II file, relative to the folder of this XML file; "
                                         "where there is none of that name, the files File.N.0 to File.N.(N-1) of a decomposed mesh")
               .notEmpty()
               .isFileName())
      .add(std::move(twoBeams))
      .exactlyOneOf({"File", "Two Beams"});
  return mesh;
}

MeshOptions meshOptions(const ParameterList& list) {
  MeshOptions mesh;
  if (list.isParameter("File")) mesh.file = list.get<std::string>("File");
  if (!list.isSublist("Two Beams")) return mesh;
  const auto& beams = list.sublist("Two Beams");
  mesh.twoBeams = TwoBeamsOptions{beams.get<int>("Subdomains Per Edge"), beams.get<int>("Elements Per Subdomain Edge")};
  return mesh;
}

ParameterTree materialsSection() {
  ParameterTree material("<material>", "One isotropic linearly elastic material; the name is yours.");
  material
      .add(ParameterSpec("Element Blocks", {Type::StringArray}, "Names or numbers of the element blocks")
               .mustBeGiven()
               .entries(1, std::numeric_limits<std::size_t>::max())
               .notEmpty())
      .add(ParameterSpec("Young's Modulus", {Type::Double}, "Elastic modulus")
               .mustBeGiven()
               .within(NumberRange::above(0))
               .measuredIn("force per area"))
      .add(ParameterSpec("Poisson's Ratio", {Type::Double}, "Ratio of lateral contraction")
               .mustBeGiven()
               .within(NumberRange::open(-1, 0.5))
               .measuredIn("-"));
  ParameterTree materials("Materials",
                          "One list for each material; every element block belongs to exactly one.");
  materials.addUserNamed(std::move(material), 1);
  return materials;
}

MaterialOptions materialOptions(const std::string& name, const ParameterList& list) {
  return {name, list.get<Teuchos::Array<std::string>>("Element Blocks").toVector(), list.get<double>("Young's Modulus"),
          list.get<double>("Poisson's Ratio")};
}

}  // namespace Haptos
