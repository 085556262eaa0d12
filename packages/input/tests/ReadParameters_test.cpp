// SPDX-License-Identifier: BSD-3-Clause
// Reading files on several ranks, malformed XML, the command line, paths.
#include <Teuchos_Array.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "Haptos_CommandLine.hpp"
#include "Haptos_ParameterValidation.hpp"
#include "TestInput.hpp"

namespace {

using namespace HaptosTest;
using namespace Haptos;

/// A file that only rank 0 writes; its name differs by rank elsewhere, so no other rank can read it.
class RootFile {
 public:
  RootFile(const Communicator& comm, const std::string& text) : root_(comm.getRank() == 0) {
    name = root_ ? "core_test_" + std::to_string(comm.getSize()) + ".xml" : "not_on_this_rank.xml";
    if (root_) std::ofstream(name) << text;
  }
  ~RootFile() {
    if (root_) std::remove(name.c_str());
  }
  std::string name;

 private:
  bool root_;
};

TEUCHOS_UNIT_TEST(ReadParameters, AllRanksGetTheFileOfRankZero) {
  const auto comm = Tpetra::getDefaultComm();
  const RootFile file(*comm, replaced(fullInput(), "2.119e5", "0.1234567890123456789"));
  CommandLine line;
  line.input = file.name;
  line.sets = {{"Decomposition->Seed", "5"}};
  line.output = "out/result.exo";
  line.summary = "s.json";
  const auto list = readParameters(*comm, line);
  const double modulus = list.sublist("Materials").sublist("steel").get<double>("Young's Modulus");
  TEST_EQUALITY(modulus, 0.1234567890123456789);  // to the last bit, on every rank
  TEST_EQUALITY(list.sublist("Decomposition").get<int>("Seed"), 5);
  TEST_EQUALITY(list.sublist("Output").get<std::string>("File"), "out/result.exo");
  TEST_EQUALITY(list.sublist("Output").get<std::string>("Summary"), "s.json");
  TEST_EQUALITY(list.sublist("Mesh").get<std::string>("File"), "mesh/two_beams.exo");
}

TEUCHOS_UNIT_TEST(ReadParameters, AllRanksThrowTheSame) {
  const auto comm = Tpetra::getDefaultComm();
  const RootFile file(*comm, replaced(fullInput(), "0.277", "0.5"));
  CommandLine line;
  line.input = file.name;
  const std::string message = messageOf([&] { readParameters(*comm, line); });
  TEST_CONTAINS(message, "Materials->steel->Poisson's Ratio", "0.5 is out of range");
  line.input = "there_is_no_such_file.xml";
  TEST_CONTAINS(messageOf([&] { readParameters(*comm, line); }), "there_is_no_such_file.xml",
                "does not exist");
  line.input = ".";
  TEST_CONTAINS(messageOf([&] { readParameters(*comm, line); }), "is a folder");
}

std::string xmlRefusal(const std::string& text) {
  return messageOf([&] { read(text); });
}

TEUCHOS_UNIT_TEST(ReadParameters, MalformedXmlIsRefusedWithItsLine) {
  TEST_CONTAINS(
      xmlRefusal("<ParameterList name=\"Haptos\">\n<ParameterList name=\"Mesh\">\n</ParameterList>\n"),
      "folder/input.xml", "malformed XML", "line");
  TEST_CONTAINS(xmlRefusal("<ParameterList name=\"Haptos\">\n<Parameter>\n</Wrong>\n</ParameterList>"),
                "line 3", "'Wrong'", "line 2");
  TEST_CONTAINS(xmlRefusal("hello"), "malformed XML", "line 1");
  TEST_CONTAINS(xmlRefusal("  \n"), "is empty");
  TEST_CONTAINS(xmlRefusal("<!-- only a comment -->"), "folder/input.xml", "malformed XML", "root");
  const std::string hidden = xmlRefusal("hello");
  TEST_ASSERT(hidden.find("Throw") == std::string::npos && hidden.find(".cpp") == std::string::npos);
}

TEUCHOS_UNIT_TEST(ReadParameters, WrongRootsAndTagsAreRefused) {
  TEST_CONTAINS(xmlRefusal("<Haptos/>"), "the root is <Haptos>", "<ParameterList name=\"Haptos\">");
  TEST_CONTAINS(xmlRefusal("<ParameterList name=\"Other\"/>"), "\"Other\"",
                "<ParameterList name=\"Haptos\">");
  TEST_CONTAINS(refusal("<Parameter name=\"Title\"", "<Paramter name=\"Title\""), "<Paramter>",
                "<Parameter>");
  TEST_CONTAINS(refusal("<Parameter name=\"Title\" type=\"string\"", "<Parameter name=\"Title\""), "Title",
                "'type'");
  TEST_CONTAINS(refusal("<Parameter name=\"Title\"", "<Parameter"), "lacks the attribute 'name'");
  TEST_CONTAINS(
      refusal("<Parameter name=\"Title\" type=\"string\"", "<Parameter name=\"Title\" type=\"text\""),
      "Title", "type 'text' is not valid", "string");
  TEST_CONTAINS(refusal("<ParameterList name=\"steel\">", "<ParameterList name=\"steel\">some text"),
                "Materials->steel", "some text");
  TEST_CONTAINS(refusal("value=\"0.277\"", "value=\"0,277\""), "Materials->steel->Poisson's Ratio", "'0,277'",
                "not of type double");
  TEST_CONTAINS(refusal("name=\"steel\"", "name=\"a->b\""), "must not contain '->'");
}

TEUCHOS_UNIT_TEST(ReadParameters, DuplicatesAreRefused) {
  const std::string title = R"(<Parameter name="Title" type="string" value="two beams"/>)";
  TEST_CONTAINS(refusal(title, title + title), "Title: is given twice");
  TEST_CONTAINS(refusal("<ParameterList name=\"Contact\">",
                        "<ParameterList name=\"Contact\"/><ParameterList name=\"Contact\">"),
                "Contact: is given twice");
  TEST_CONTAINS(refusal("name=\"press\"", "name=\"clamp\""), "Boundary Conditions->clamp: is given twice");
}

TEUCHOS_UNIT_TEST(ReadParameters, ByteOrderMarkIsAccepted) {
  TEST_EQUALITY(xmlRefusal("\xEF\xBB\xBF" + fullInput()), "(nothing thrown)");
}

TEUCHOS_UNIT_TEST(ResolvePath, JoinsOnlyRelativeNames) {
  TEST_EQUALITY(resolvePath("a/b", "../c.exo"), "a/c.exo");
  TEST_EQUALITY(resolvePath("a", "b.exo"), "a/b.exo");
  TEST_EQUALITY(resolvePath("", "b.exo"), "b.exo");
  TEST_EQUALITY(resolvePath("a", "/b.exo"), "/b.exo");
  TEST_EQUALITY(resolvePath("a", ""), "");
}

TEUCHOS_UNIT_TEST(CommandLine, OptionsInAnyOrder) {
  const auto line =
      parseCommandLine({"--set", "Solver->Relative Tolerance=1e-8", "in.xml", "--output=a.exo", "--summary",
                        "b.json", "--set=Boundary Conditions->p->Value=x == 1 ? 2 : 3", "--validate-only"});
  TEST_EQUALITY(line.input, "in.xml");
  TEST_EQUALITY(line.sets.size(), 2);
  TEST_EQUALITY(line.sets[0].first, "Solver->Relative Tolerance");
  TEST_EQUALITY(line.sets[0].second, "1e-8");
  TEST_EQUALITY(line.sets[1].second, "x == 1 ? 2 : 3");
  TEST_EQUALITY(line.output, "a.exo");
  TEST_EQUALITY(line.summary, "b.json");
  TEST_ASSERT(line.validateOnly && !line.printParameters && !line.version && !line.help);
  const char* arguments[] = {"haptos", "--version"};
  TEST_ASSERT(parseCommandLine(2, arguments).version);
  TEST_ASSERT(parseCommandLine({"-h"}).help && parseCommandLine({"--print-parameters"}).printParameters);
  TEST_CONTAINS(helpText(), "--validate-only", "--set", "Exit status");
  TEST_CONTAINS(versionText(), "haptos " + versionNumber());
}

std::string lineRefusal(const std::vector<std::string>& arguments) {
  return messageOf([&] { parseCommandLine(arguments); });
}

TEUCHOS_UNIT_TEST(CommandLine, MistakesAreRefused) {
  TEST_CONTAINS(lineRefusal({"in.xml", "--ouput", "a"}), "'--ouput'", "did you mean '--output'?");
  TEST_CONTAINS(lineRefusal({"in.xml", "--validate"}), "did you mean '--validate-only'?");
  TEST_CONTAINS(lineRefusal({"in.xml", "-x"}), "unknown option '-x'");
  TEST_CONTAINS(lineRefusal({}), "no input file");
  TEST_CONTAINS(lineRefusal({"a.xml", "b.xml"}), "'a.xml' and 'b.xml'");
  TEST_CONTAINS(lineRefusal({"a.xml", "--output"}), "--output: its value is missing");
  TEST_CONTAINS(lineRefusal({"a.xml", "--output", "--summary", "b"}), "--output: its value is missing");
  TEST_CONTAINS(lineRefusal({"a.xml", "--output", "b", "--output", "c"}), "given twice");
  TEST_CONTAINS(lineRefusal({"a.xml", "--set", "Title"}), "--set 'Title'", "Relative Tolerance=1e-8");
  TEST_CONTAINS(lineRefusal({"a.xml", "--version=1"}), "takes no value");
}

}  // namespace
