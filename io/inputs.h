#pragma once
// Turns the INPUT arguments of a command into the list of files that they mean.

#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace pss {

/// Files in the order of the arguments. An argument is
///   a file, or a store (a directory NAME.pss), taken as it is;
///   another directory: its files with extensions of formats in the table, by name;
///   a glob (*, ?, [...]) where no file has that very name: its matches, by name;
///   @LIST: a file with one argument a line; empty lines are skipped, lists in lists refused.
/// `output` is left out of what directories and globs give: the same command finds the same inputs
/// when its output has come to lie among them.
///
/// Errors: kFailed naming what is missing or matches nothing; kUsage for a file that is there twice
///         (by whatever names or links: each of its points would have a twin); those of
///         check_lists() for `output`.
Result<std::vector<std::string>> expand_inputs(std::span<const std::string> arguments,
                                               const std::string& output = {});

/// Refuses a path to be written that is a list among the arguments: it is input, too.
///
/// Errors: kUsage.
Result<void> check_lists(std::span<const std::string> arguments, const std::string& path);

/// Refuses, before any work, an output that is one of the inputs, lies in one that is a store, is a
/// directory although not called a store, or lies in a missing folder.
///
/// Errors: kUsage for an input, by whatever name or link; kFailed for the directory and the folder.
Result<void> check_output(std::span<const std::string> inputs, const std::string& output);

/// Refuses stores, for commands that read files alone. Errors: kUsage.
Result<void> check_files(std::span<const std::string> inputs);

}  // namespace pss
