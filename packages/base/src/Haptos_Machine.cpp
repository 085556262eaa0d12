// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Machine.hpp"

#include <Trilinos_version.h>
#include <dlfcn.h>
#include <mpi.h>
#include <unistd.h>

#include <fstream>

#include "Haptos_Exchange.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

std::string hostName() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::string processorModel() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) return line.substr(line.find(": ") + 2);
  return "";
}

// Only the first words: some libraries tell who built them, too.
std::string mpiName() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int size = 0;
  MPI_Get_library_version(text, &size);
  const std::string all(text, std::size_t(size));
  return all.substr(0, all.find_first_of(",\n"));
}

// Which BLAS a program has is decided where it starts, not where it was linked.
std::string blasName() {
  if (auto config = reinterpret_cast<const char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_config"))) return config();
  Dl_info info{};
  if (dladdr(dlsym(RTLD_DEFAULT, "dgemm_"), &info) == 0 || info.dli_fname == nullptr) return "";
  const std::string path = info.dli_fname;
  return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

Machine describeMachine(const Communicator& comm) {
  Machine machine;
  machine.hosts = sumOfAll(comm, int(lowestRankOfNode(comm) == comm.getRank()));
  if (comm.getRank() != 0) return machine;
  machine.host = hostName();
  machine.processors = int(sysconf(_SC_NPROCESSORS_ONLN));
  machine.processor = processorModel();
  machine.mpi = mpiName();
  machine.blas = blasName();
  machine.trilinos = TRILINOS_VERSION_STRING;
  machine.compiler = __VERSION__;
  return machine;
}

}  // namespace Haptos
