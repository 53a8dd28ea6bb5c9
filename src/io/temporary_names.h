#pragma once

#include <string>

namespace mindahl::io {

/// A file, or a directory that is empty by then, which goes with this object unless it is kept; and
/// with the program, when RemoveTemporaryFilesOnSignals() was called and a signal ends it.
class TemporaryName {
 public:
  /// Before the file is made: a signal may come in between.
  explicit TemporaryName(std::string name);
  ~TemporaryName();
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  void Keep();
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  bool kept_ = false;
};

}  // namespace mindahl::io
