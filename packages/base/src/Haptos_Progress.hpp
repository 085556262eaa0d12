// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <iosfwd>
#include <string>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief Tells the user what the run is doing: "[    1.2 s] iteration 12, residual 3e-4".
///
/// On a terminal `update` rewrites one line; in a log it prints plain lines, at most one per interval.
/// Rank 0 prints; calls on the other ranks do nothing, and no call communicates.
class Progress {
 public:
  /// \brief Where and how to print; the defaults are those of a program.
  struct Options {
    std::ostream* out = nullptr;    ///< null: std::cout
    std::ostream* err = nullptr;    ///< null: std::cerr
    bool terminal = false;          ///< `out` is a terminal
    double logInterval = 5.0;       ///< [s] least time between two updates in a log
    double terminalInterval = 0.1;  ///< [s] the same on a terminal
    std::function<double()> now;    ///< [s]; empty: the wall clock
  };

  /// To stdout and stderr.
  explicit Progress(const Communicator& comm);
  Progress(const Communicator& comm, Options options);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A line that stays; an update that was held back is printed before it.
  void line(const std::string& text);
  /// The state of something that goes on; may be replaced by the next one or held back.
  void update(const std::string& text);
  /// "haptos: warning: text" to stderr.
  void warn(const std::string& text);
  /// Prints what was held back and ends the updating line; the destructor does so too.
  void finish();

 private:
  std::string stamped(const std::string& text) const;
  void show(const std::string& text);

  bool prints_;
  Options options_;
  double start_;
  double lastShown_;
  std::string pending_;         ///< an update that was held back
  std::size_t openLength_ = 0;  ///< length of the updating line on the terminal, 0 if there is none
};

}  // namespace Haptos
