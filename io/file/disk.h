#pragma once
// The system calls of the file layer, a function each, so that a test can link another disk.

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pss::disk {

/// What a call gives: 0 or more is its value, less is an errno, negated. A call does no more than
/// its system call does: reads and writes may be short, and each may be interrupted (EINTR).
using Outcome = std::int64_t;

/// To write, a file is opened under its own name or not at all: where the name is a link, the call
/// fails (ELOOP, or EEXIST for kCreateNew), because what it leads to may be anybody's.
enum class Open {
  kRead,       ///< follows links
  kCreateNew,  ///< to read and write; -EEXIST where the name is taken, by whatever
  kReadWrite   ///< to read and write a file that is there
};
enum class Kind { kFile, kDirectory, kLink, kOther };
enum class Links { kFollow, kKeep };
enum class Lock { kShared, kExclusive };

struct Status {
  Kind kind = Kind::kOther;
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::uint64_t links = 1;  ///< names that lead to it: more than one for hard links
  bool mounted = false;     ///< another file system, or a bind mount, begins here
};

/// Gives a descriptor, which close() gives back. Never waits, not even for a pipe's writer.
Outcome open(const std::string& path, Open how);
void close(int descriptor);
/// Gives the number of bytes; 0 at the end of the file.
Outcome read(int descriptor, std::uint64_t offset, std::span<std::byte> out);
Outcome write(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes);
Outcome truncate(int descriptor, std::uint64_t size);
/// fsync, not fdatasync: the size is durable with the bytes, and so is the time that a record has.
Outcome sync(int descriptor);
/// Never waits: -EWOULDBLOCK where another process holds it.
Outcome lock(int descriptor, Lock kind);
/// The process that holds a lock on this file; -ESRCH where this machine knows of none.
Outcome lock_holder(int descriptor);
Outcome status(int descriptor, Status& out);
Outcome status(const std::string& path, Links links, Status& out);

/// The names in a directory, in any order, without . and ..
Outcome list(const std::string& path, std::vector<std::string>& names);
/// The paths that a pattern of *, ? and [...] matches, by name; -ENOENT where there is none.
Outcome match(const std::string& pattern, std::vector<std::string>& paths);
Outcome make_directory(const std::string& path);
Outcome remove_directory(const std::string& path);
Outcome remove_file(const std::string& path);
Outcome rename(const std::string& from, const std::string& to);
/// -EEXIST where `to` is there; -EINVAL or -ENOSYS where the file system has no such call.
Outcome rename_to_free(const std::string& from, const std::string& to);
/// Swaps two names, both there, at once; -EINVAL or -ENOSYS where the file system cannot.
Outcome exchange(const std::string& a, const std::string& b);
/// Makes the names in a directory durable.
Outcome sync_directory(const std::string& path);

Outcome free_space(const std::string& path, std::uint64_t& bytes);
/// The path without links and dots, as far as it exists; as it is where that cannot be told.
std::string canonical(const std::string& path);

/// Calls again as long as signals interrupt it.
template <class Call>
Outcome uninterrupted(const Call& call) {
  Outcome outcome = 0;
  do {
    outcome = call();
  } while (outcome == -EINTR);
  return outcome;
}

}  // namespace pss::disk
