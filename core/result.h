#pragma once
// The value of a call that can fail because of the world: a result or an Error, never an exception.

#include <cassert>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace pss {

/// What kind of failure this is; the values are the program's exit codes.
enum class Fault : int {
  kFailed = 1,         ///< I/O, disk full, lock held, refused to overwrite or resume
  kUsage = 2,          ///< the command line, or a parameter that makes no sense
  kBadInput = 3,       ///< a file that is damaged, unsupported, or does not fit the others
  kMemoryLimit = 4,    ///< the work does not fit in the memory limit
  kInterrupted = 130,  ///< stopped by a signal; the same command resumes
};

/// One sentence for a person: file, offset, found, expected, and what to do.
struct Error {
  Fault fault = Fault::kFailed;
  std::string message;
};

/// A `T`, or the Error that kept it from being made. Shaped like std::expected<T, Error>.
template <class T>
class [[nodiscard]] Result {
 public:
  using value_type = T;

  template <class U = T>
  requires std::is_convertible_v<U&&, T> Result(U&& value)
      : state_(std::in_place_index<0>, std::forward<U>(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& value() & { return assert(has_value()), std::get<0>(state_); }
  const T& value() const& { return assert(has_value()), std::get<0>(state_); }
  T&& value() && { return assert(has_value()), std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Error& error() const& { return std::get<1>(state_); }
  Error&& error() && { return std::get<1>(std::move(state_)); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  using value_type = void;

  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  const Error& error() const& { return *error_; }
  Error&& error() && { return *std::move(error_); }

 private:
  std::optional<Error> error_;
};

// The two macros of this project: they return the Error of `expr` to the caller, or go on.
//   PSS_TRY(file.sync());                       for Result<void>
//   PSS_ASSIGN(auto header, read_header(file));  for Result<T>
#define PSS_CONCAT_INNER(a, b) a##b
#define PSS_CONCAT(a, b) PSS_CONCAT_INNER(a, b)
#define PSS_TRY(expr) \
  if (auto pss_result = (expr); !pss_result) return std::move(pss_result).error()
#define PSS_ASSIGN(declaration, expr)                            \
  auto PSS_CONCAT(pss_result_, __LINE__) = (expr);               \
  if (!PSS_CONCAT(pss_result_, __LINE__))                        \
    return std::move(PSS_CONCAT(pss_result_, __LINE__)).error(); \
  declaration = *std::move(PSS_CONCAT(pss_result_, __LINE__))

}  // namespace pss
