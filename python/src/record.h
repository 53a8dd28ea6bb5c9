#pragma once

#include <string>

#include "mindahl/io/record_reader.h"

namespace mindahl::python {

/// A record and what it is called in messages and reports.
struct NamedRecord {
  std::string name;
  io::RecordFile file;
};

}  // namespace mindahl::python
