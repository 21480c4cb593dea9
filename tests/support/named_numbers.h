#pragma once
// Reads the value of an option that a message names.

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace pss::test {

/// The numbers of "OPTION=A,B,..." in a message; none where it does not name the option.
inline std::vector<double> named_numbers(const std::string& message, const std::string& option) {
  const std::size_t at = message.find(option + "=");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + option.size() + 1;
  const std::size_t end = std::min(message.find_first_of(" ;", begin), message.size());
  std::stringstream list(message.substr(begin, end - begin));
  std::vector<double> numbers;
  for (std::string number; std::getline(list, number, ',');) numbers.push_back(std::stod(number));
  return numbers;
}

}  // namespace pss::test
