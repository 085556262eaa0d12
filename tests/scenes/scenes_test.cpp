// SPDX-License-Identifier: BSD-3-Clause
// Runs scenes on which contact methods fail and compares them with the dense reference.
//
//   scenes_test --scene NAME [--scene NAME]... | --all | --list | --registered "NAME;NAME;..."
//               [--method M] [--tolerance T] [--decomposition D] [--table FILE] [--some-rank-without contact|subdomains]
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultComm.hpp>
#include <Tpetra_Core.hpp>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "SceneRun.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

struct Options {
  std::vector<Scene> scenes;
  SceneOptions run;
  std::string table, decomposition;
  bool list = false;
  std::string registered;  ///< names joined by ';'
};

Options parse(int argc, char* argv[]) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw std::invalid_argument(name + " needs a value");
      return std::string(argv[i]);
    };
    if (name == "--scene") options.scenes.push_back(findScene(value()));
    else if (name == "--all") options.scenes = allScenes();
    else if (name == "--list") options.list = true;
    else if (name == "--registered") options.registered = value();
    else if (name == "--method") options.run.method = value();
    else if (name == "--tolerance") options.run.tolerance = std::stod(value());
    else if (name == "--table") options.table = value();
    else if (name == "--some-rank-without") (value() == "contact" ? options.run.idleContact : options.run.idleSubdomains) = true;
    else if (name == "--decomposition") options.decomposition = value();
    else throw std::invalid_argument("unknown option " + name);
  }
  for (auto& scene : options.scenes) {
    if (options.decomposition.empty()) continue;
    scene.decomposition = options.decomposition;
    scene.subdomains = 0;
  }
  if (options.scenes.empty() && options.registered.empty() && !options.list) throw std::invalid_argument("give --scene NAME, --all or --list");
  return options;
}

// Whether the build's list of tests has every scene.
int checkRegistered(const std::string& registered) {
  int missing = 0;
  for (const auto& scene : allScenes())
    if ((";" + registered + ";").find(";" + scene.name + ";") == std::string::npos) {
      std::cout << "scene '" << scene.name << "' is not registered as a test" << std::endl;
      ++missing;
    }
  return missing == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

// Replaces what stands between the two marks of the page.
void writeTable(const std::string& file, const std::string& table) {
  const std::string begin = "<!-- table: begin -->\n", end = "<!-- table: end -->";
  std::ifstream in(file);
  std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto from = page.find(begin), to = page.find(end);
  if (from == std::string::npos || to == std::string::npos) throw std::runtime_error(file + " lacks the marks of the table");
  page.replace(from + begin.size(), to - from - begin.size(), table + "\n");
  std::ofstream(file) << page;
}

int runAll(const Options& options) {
  const auto comm = Tpetra::getDefaultComm();
  const bool prints = comm->getRank() == 0;
  std::vector<SceneOutcome> outcomes;
  int failed = 0;
  for (const auto& scene : options.scenes) {
    SceneOutcome outcome = runScene(comm, scene, options.run);
    if (!scene.twin.empty()) {
      const Scene& twin = findScene(scene.twin);
      const SceneOutcome other = runScene(comm, twin, options.run);
      if (prints) compareWithTwin(scene, outcome, twin, other);
    }
    failed += !outcome.failures.empty();
    if (prints) std::cout << summaryLine(scene, outcome) << std::endl;
    outcomes.push_back(std::move(outcome));
  }
  if (prints) std::cout << options.scenes.size() - std::size_t(failed) << " of " << options.scenes.size() << " scenes hold" << std::endl;
  if (prints && !options.table.empty()) writeTable(options.table, markdownTable(options.scenes, outcomes));
  Teuchos::broadcast(*comm, 0, Teuchos::outArg(failed));
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char* argv[]) {
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  Tpetra::ScopeGuard mpi(&argc, &argv);
  try {
    const Options options = parse(argc, argv);
    if (!options.registered.empty()) return checkRegistered(options.registered);
    if (!options.list) return runAll(options);
    for (const auto& scene : allScenes()) std::cout << scene.name << "\n";
    return EXIT_SUCCESS;
  } catch (const std::exception& e) {
    std::cerr << "scenes_test: " << e.what() << std::endl;
    return EXIT_FAILURE;
  }
}
