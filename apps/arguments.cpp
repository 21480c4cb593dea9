#include "apps/arguments.h"

#include <CLI/CLI.hpp>
#include <sstream>

namespace pss {

namespace {

constexpr std::size_t kHelpColumns = 68;

/// Broken into lines, as CLI11 does not.
std::string wrapped(const std::string& text) {
  std::string out;
  std::size_t column = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const bool breaks = column > 0 && column + 1 + word.size() > kHelpColumns;
    if (column > 0) out += breaks ? '\n' : ' ';
    column = breaks ? word.size() : column + word.size() + (column > 0 ? 1 : 0);
    out += word;
  }
  return out;
}

/// What CLI11 calls for an option's value.
CLI::callback_t taker(const std::string& names,
                      std::function<Result<void>(std::string_view)> take) {
  return [names, take = std::move(take)](const CLI::results_t& words) {
    const Result<void> taken = take(words.front());
    if (!taken) throw CLI::ValidationError(names, taken.error().message);
    return true;
  };
}

}  // namespace

void Arguments::positionals(const std::string& name, const std::string& help,
                            std::vector<std::string>& to) {
  app_.add_option(name, to, wrapped(help))->required()->option_text("...");
}

void Arguments::positional(const std::string& name, const std::string& help, std::string& to) {
  app_.add_option(name, to, wrapped(help))->required()->option_text(" ");
}

void Arguments::flag(const std::string& names, const std::string& help, bool& to) {
  app_.add_flag(names, to, wrapped(help));
}

void Arguments::take(const std::string& names, const std::string& word, const std::string& help,
                     Take take) {
  app_.add_option(names, taker(names, std::move(take)), wrapped(help))
      ->option_text(word)
      ->type_size(1)
      ->expected(1);
}

void Arguments::choice(const std::string& names, const std::vector<std::string>& words,
                       const std::string& help, std::string& to) {
  take(names, CLI::detail::join(words, "|"), help, [&to, words](std::string_view given) {
    for (const std::string& word : words)
      if (word == given) return to = word, Result<void>();
    const std::string all = CLI::detail::join(words, ", ");
    return Result<void>(
        Error{Fault::kUsage, "found '" + std::string(given) + "', expected one of " + all});
  });
}

void Arguments::required() { app_.get_options().back()->required(); }

void Arguments::epilogue(const std::string& text) { app_.footer(text); }

}  // namespace pss
