#pragma once
// The common shape of the subcommands: one class a command, whose options are its members.

#include <memory>

#include "apps/arguments.h"
#include "core/result.h"

namespace pss {

class Command {
 public:
  virtual ~Command() = default;

  /// Adds the command's options, examples and units to its part of the command line.
  virtual void declare(Arguments& arguments) = 0;

  /// Does the work, once the command line has been read.
  virtual Result<void> run() = 0;

  /// Whether the same command goes on where an interrupted one stopped.
  virtual bool resumable() const { return false; }
};

std::unique_ptr<Command> make_convert();
std::unique_ptr<Command> make_denoise();
std::unique_ptr<Command> make_export();
std::unique_ptr<Command> make_info();
std::unique_ptr<Command> make_smooth();
std::unique_ptr<Command> make_synth();
std::unique_ptr<Command> make_tile();
std::unique_ptr<Command> make_verify();

}  // namespace pss
