/// \file
/// A folder without rights.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <utility>

namespace stickslip::test {

/// Nobody may look into the folder; root becomes somebody who asks for permission.
class ClosedFolder {
 public:
  explicit ClosedFolder(std::filesystem::path folder)
      : folder_{std::move(folder)}, was_root_{::geteuid() == 0} {
    std::filesystem::permissions(folder_, std::filesystem::perms::none);
    constexpr uid_t kNobody = 65534;
    if (was_root_ && ::seteuid(kNobody) != 0) ADD_FAILURE() << "root cannot become nobody";
  }
  ~ClosedFolder() {
    if (was_root_ && ::seteuid(0) != 0) ADD_FAILURE() << "root's rights are gone";
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
  }
  ClosedFolder(const ClosedFolder&) = delete;
  ClosedFolder& operator=(const ClosedFolder&) = delete;

 private:
  std::filesystem::path folder_;
  bool was_root_;
};

}  // namespace stickslip::test
