// SPDX-License-Identifier: BSD-3-Clause
// Runs `haptos` again and again in the current folder, each run in a child process that starts after MPI and Kokkos have begun:
// thousands of inputs in the time of hundreds.  A line on stdin holds the arguments of one run, each in hexadecimal and a comma
// after it; the run's stdout and stderr go to the files `out` and `err`, and a line on stdout tells how it ended:
//
//     exit status, or minus the signal;  seconds;  growth of the peak memory in MB
//
//     haptos_fuzz_server SECONDS [BYTES]      a run is stopped (signal 14) after so many seconds; its files may grow to BYTES
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Tpetra_Core.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "Haptos_Program.hpp"

namespace {

std::vector<std::string> decoded(const std::string& line) {
  std::vector<std::string> arguments(1, "haptos");
  std::string argument;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == ',') {
      arguments.push_back(argument);
      argument.clear();
    } else {
      argument += char(std::stoi(line.substr(i++, 2), nullptr, 16));
    }
  }
  return arguments;
}

void sendTo(const char* file, int descriptor) {
  const int target = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(target, descriptor);
  close(target);
}

struct Limits {
  unsigned seconds;
  rlim_t fileBytes = RLIM_INFINITY;
};

[[noreturn]] void runChild(const std::vector<std::string>& arguments, const Limits& limits) {
  sendTo("out", STDOUT_FILENO);
  sendTo("err", STDERR_FILENO);
  alarm(limits.seconds);
  const rlimit files{limits.fileBytes, limits.fileBytes};
  setrlimit(RLIMIT_FSIZE, &files);
  std::signal(SIGXFSZ, SIG_IGN);  // then writing fails, as on a full disk
  std::vector<char*> argv;
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int status = Haptos::runProgram(Tpetra::getDefaultComm(), int(arguments.size()), argv.data());
  std::cout.flush();
  std::fflush(nullptr);
  _exit(status);  // MPI ends with the parent
}

double peakMb(const rusage& usage) { return double(usage.ru_maxrss) / 1024.0; }

void serve(const std::string& line, const Limits& limits) {
  const auto arguments = decoded(line);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) runChild(arguments, limits);
  int status = 0;
  rusage usage{}, own{};
  wait4(child, &status, 0, &usage);
  getrusage(RUSAGE_SELF, &own);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  std::printf("%d %.3f %.1f\n", WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status), taken.count(),
              peakMb(usage) - peakMb(own));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char* argv[]) {
  const int seconds = argc == 2 || argc == 3 ? std::atoi(argv[1]) : 0;
  Limits limits{unsigned(seconds)};
  if (argc == 3) limits.fileBytes = rlim_t(std::atoll(argv[2]));
  if (seconds <= 0) {
    std::cerr << "usage: haptos_fuzz_server SECONDS [BYTES]\n";
    return 1;
  }
  char* programAlone[] = {argv[0], nullptr};
  char** arguments = programAlone;
  int count = 1;
  Tpetra::ScopeGuard mpi(&count, &arguments);
  for (std::string line; std::getline(std::cin, line);) serve(line, limits);
}
