// The pss program: reads the command line, runs one subcommand, turns what became of it into an
// exit code.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <optional>
#include <span>
#include <sstream>

#include "apps/command.h"
#include "apps/out_of_memory.h"
#include "apps/signals.h"
#include "apps/standard_streams.h"
#include "stream/limit/memory.h"

namespace pss {
namespace {

struct Entry {
  const char* name;
  const char* alias;
  const char* summary;
  std::unique_ptr<Command> (*make)();
};

constexpr Entry kCommands[] = {
    {"smooth", "project", "Project every point onto the scan's moving-least-squares surface",
     make_smooth},
    {"denoise", "", "Drop outliers, or classify them as noise", make_denoise},
    {"tile", "", "Build a store of sorted tiles once, to use it many times", make_tile},
    {"export", "", "Write a store as a file", make_export},
    {"convert", "", "Rewrite files in another format, every attribute and the order kept",
     make_convert},
    {"info", "", "Tell what is in a file, a store or a work directory", make_info},
    {"verify", "", "Check every checksum and count of a store; print the hash of its rows",
     make_verify},
    {"synth", "", "Make noisy scans of known surfaces; measure how far points are from them",
     make_synth},
};

constexpr const char* kDescription =
    "pss: moving least squares for point scans larger than memory.";
constexpr const char* kEpilogue =
    "pss COMMAND --help explains each command, with examples.\n"
    "Words go to stderr, data to stdout. Exit codes: 0 done, 1 failed (I/O, disk full, refused to\n"
    "overwrite), 2 usage, 3 bad input, 4 memory limit too small, 130 interrupted, resumable.";

/// A declared subcommand and the class behind it.
struct Declared {
  CLI::App* app;
  std::unique_ptr<Command> command;
};

std::vector<Declared> declare_all(CLI::App& app) {
  std::vector<Declared> all;
  for (const Entry& entry : kCommands) {
    all.push_back({app.add_subcommand(entry.name, entry.summary), entry.make()});
    if (*entry.alias) all.back().app->alias(entry.alias);
    Arguments arguments(*all.back().app);
    all.back().command->declare(arguments);
  }
  return all;
}

/// A word as a shell takes it.
std::string quoted(const std::string& word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string out = "'";
  for (char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

int fail(const Error& error, bool resumable, std::span<char*> words) {
  std::string text = fmt::format("pss: {}\n", error.message);
  if (error.fault == Fault::kInterrupted && resumable) {
    text += "pss: this goes on where it stopped:\n   ";
    for (const char* word : words) text += " " + quoted(word);
    text += "\n";
  }
  print_words(text);
  return static_cast<int>(error.fault);
}

/// Help, the version, or what is wrong with the command line.
int answer(const CLI::App& app, const CLI::ParseError& stop) {
  std::ostringstream data, words;
  const bool asked = app.exit(stop, data, words) == 0;
  if (!asked) print_words("pss: " + words.str());
  const Result<void> printed = print_data(data.str());
  if (!printed) return fail(printed.error(), false, {});
  return asked ? 0 : static_cast<int>(Fault::kUsage);
}

int run(int argc, char** argv) {
  CLI::App app(kDescription, "pss");
  app.get_formatter()->column_width(26);
  app.set_version_flag("--version", "pss " PSS_VERSION);
  app.footer(kEpilogue);
  app.require_subcommand(1);
  const std::vector<Declared> all = declare_all(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    return answer(app, stop);
  }
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  for (const auto& [sub, command] : all) {
    if (!sub->parsed()) continue;
    const Result<void> result = command->run();
    if (!result) return fail(result.error(), command->resumable(), words);
  }
  return 0;
}

}  // namespace
}  // namespace pss

int main(int argc, char** argv) {
  pss::exit_on_signals();  // first: before a job there is nothing to stop in order
  pss::let_writes_fail();
  pss::exit_when_out_of_memory();
  pss::configure_allocator();
  try {
    if (const auto opened = pss::open_missing_streams(); !opened)
      return pss::fail(opened.error(), false, {});
    return pss::run(argc, argv);
  } catch (const std::exception& unexpected) {
    pss::exit_if_out_of_memory(std::current_exception());
    pss::print_words(fmt::format("pss: unexpected: {}\n", unexpected.what()));
  }
  return static_cast<int>(pss::Fault::kFailed);
}
