#pragma once
// Names of files in JSON: JSON is UTF-8, a name is any bytes.

#include <string>

namespace pss {

/// The name as it is where it is UTF-8 without '%'; else '%' and bytes above 127 become %XX.
std::string json_text_of(const std::string& name);
/// The name again.
std::string name_of_json_text(const std::string& text);

}  // namespace pss
