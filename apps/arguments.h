#pragma once
// The options of one subcommand, bound to the variables that receive them. Hides CLI11.

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace CLI {
class App;
}

namespace pss {

/// Declares options; what the user gave is in the bound variables once the line has been read.
///
/// Requires: the variables outlive the parsing.
class Arguments {
 public:
  explicit Arguments(CLI::App& app) : app_(app) {}

  /// One or more words without a flag, required.
  void positionals(const std::string& name, const std::string& help, std::vector<std::string>& to);
  /// One word without a flag, required.
  void positional(const std::string& name, const std::string& help, std::string& to);
  /// A flag that takes no value.
  void flag(const std::string& names, const std::string& help, bool& to);

  /// An option with a value: option("--threads", "N", "...", threads_, parse_integer).
  ///
  /// Shape:  `names` as "-o,--output"; `word` stands for the value in --help.
  /// Errors: the parser's message, after the option's name; the program exits with 2.
  template <class T, class Value>
  void option(const std::string& names, const std::string& word, const std::string& help, T& to,
              Result<Value> (*parse)(std::string_view)) {
    take(names, word, help, [&to, parse](std::string_view text) -> Result<void> {
      PSS_ASSIGN(to, parse(text));
      return {};
    });
  }
  /// An option whose value is one of a few words.
  void choice(const std::string& names, const std::vector<std::string>& words,
              const std::string& help, std::string& to);

  /// The options declared last must be given.
  void required();
  /// Text at the end of --help: examples, units.
  void epilogue(const std::string& text);

 private:
  using Take = std::function<Result<void>(std::string_view)>;
  void take(const std::string& names, const std::string& word, const std::string& help, Take take);

  CLI::App& app_;
};

}  // namespace pss
