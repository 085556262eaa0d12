// SPDX-License-Identifier: BSD-3-Clause
// Runs `haptos` again and again in the current folder, after one start of MPI and Kokkos: thousands of inputs in the time of
// hundreds.  A line on stdin holds the arguments of one run, each in hexadecimal and a comma after it; the run's stdout and
// stderr go to the files `out` and `err`, and a line on stdout tells how it ended:
//
//     exit status, or minus the signal;  seconds;  growth of the peak memory in MB
//
//     haptos_fuzz_server SECONDS [BYTES]      a run is stopped (signal 14) after so many seconds; its files may grow to BYTES
//     haptos_fuzz_server --stay SECONDS       all runs in one process (a rank), which ends with the first that does not end well
//
// Several ranks must stay, as MPI forbids to fork; under AddressSanitizer a copy of the process costs more than most runs.
#include <fcntl.h>
#include <mpi.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Tpetra_Core.hpp>
#include <algorithm>
#include <array>
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

/// Ranks write behind each other's lines; the files are made by who starts the run.
void sendTo(const char* file, int descriptor, int flags = 0) {
  const int target = open(file, O_WRONLY | O_APPEND | flags, 0600);
  dup2(target, descriptor);
  close(target);
}

struct Limits {
  unsigned seconds = 0;
  rlim_t fileBytes = RLIM_INFINITY;
  bool stay = false;
};

int run(const std::string& line) {
  const auto arguments = decoded(line);
  std::vector<char*> argv;
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int status = Haptos::runProgram(Tpetra::getDefaultComm(), int(arguments.size()), argv.data());
  std::cout.flush();
  std::fflush(nullptr);
  return status;
}

[[noreturn]] void runChild(const std::string& line, const Limits& limits) {
  sendTo("out", STDOUT_FILENO, O_CREAT | O_TRUNC);
  sendTo("err", STDERR_FILENO, O_CREAT | O_TRUNC);
  alarm(limits.seconds);
  const rlimit files{limits.fileBytes, limits.fileBytes};
  setrlimit(RLIMIT_FSIZE, &files);
  std::signal(SIGXFSZ, SIG_IGN);  // then writing fails, as on a full disk
  _exit(run(line));  // MPI ends with the parent
}

using Clock = std::chrono::steady_clock;

void answer(int status, Clock::time_point start, double megabytes) {
  const std::chrono::duration<double> taken = Clock::now() - start;
  std::printf("%d %.3f %.1f\n", status, taken.count(), megabytes);
  std::fflush(stdout);
}

double ownPeakMb() {
  rusage own{};
  getrusage(RUSAGE_SELF, &own);
  return double(own.ru_maxrss) / 1024.0;
}

void serve(const std::string& line, const Limits& limits) {
  const auto start = Clock::now();
  const pid_t child = fork();
  if (child == 0) runChild(line, limits);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  answer(WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status), start, double(usage.ru_maxrss) / 1024.0 - ownPeakMb());
}

/// Beginning with what there is now.
void measurePeakAnew() {
  if (std::FILE* file = std::fopen("/proc/self/clear_refs", "w")) {
    std::fputs("5", file);
    std::fclose(file);
  }
}

/// The next line of rank 0's stdin.  \return false at its end
bool nextLine(std::string& line) {
  const int rank = Tpetra::getDefaultComm()->getRank();
  int size = rank == 0 && std::getline(std::cin, line) ? int(line.size()) : -1;
  MPI_Bcast(&size, 1, MPI_INT, 0, MPI_COMM_WORLD);
  line.resize(std::size_t(std::max(0, size)));
  MPI_Bcast(line.data(), std::max(0, size), MPI_CHAR, 0, MPI_COMM_WORLD);
  return size >= 0;
}

/// Ranks that do not agree how a run ended count as signal 99.
void serveStaying(const std::string& line, const Limits& limits, const std::array<int, 2>& own) {
  const auto start = Clock::now();
  measurePeakAnew();
  const double before = ownPeakMb();
  if (Tpetra::getDefaultComm()->getRank() == 0)
    for (const char* file : {"out", "err"}) close(open(file, O_WRONLY | O_CREAT | O_TRUNC, 0600));
  MPI_Barrier(MPI_COMM_WORLD);
  sendTo("out", STDOUT_FILENO);
  sendTo("err", STDERR_FILENO);
  alarm(limits.seconds);
  const int status = run(line);
  alarm(0);
  std::array<int, 2> ends{status, -status};
  MPI_Allreduce(MPI_IN_PLACE, ends.data(), 2, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  dup2(own[0], STDOUT_FILENO);
  dup2(own[1], STDERR_FILENO);
  if (Tpetra::getDefaultComm()->getRank() == 0) answer(ends[0] == -ends[1] ? status : -99, start, ownPeakMb() - before);
}

}  // namespace

int main(int argc, char* argv[]) {
  Limits limits;
  const std::vector<std::string> words(argv + 1, argv + argc);
  limits.stay = !words.empty() && words[0] == "--stay";
  const std::size_t first = limits.stay ? 1 : 0;
  if (words.size() > first) limits.seconds = unsigned(std::atoi(words[first].c_str()));
  if (words.size() > first + 1) limits.fileBytes = rlim_t(std::atoll(words[first + 1].c_str()));
  if (limits.seconds == 0 || words.size() > 2) {
    std::cerr << "usage: haptos_fuzz_server SECONDS [BYTES] | --stay SECONDS\n";
    return 1;
  }
  char* programAlone[] = {argv[0], nullptr};
  char** arguments = programAlone;
  int count = 1;
  Tpetra::ScopeGuard mpi(&count, &arguments);
  const std::array<int, 2> own{dup(STDOUT_FILENO), dup(STDERR_FILENO)};
  for (std::string line; nextLine(line);) limits.stay ? serveStaying(line, limits, own) : serve(line, limits);
}
