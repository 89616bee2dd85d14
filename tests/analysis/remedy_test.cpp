// Every status but ok has advice, which names only what exists.

#include "manycontact/analysis/remedy.hpp"

#include <gtest/gtest.h>

namespace manycontact::test {
namespace {

constexpr Reason kReasons[] = {
    Reason::kNone,          Reason::kZeroPivot,       Reason::kWrongInertia,    Reason::kSmallPivot,
    Reason::kLargeResidual, Reason::kNotFinite,       Reason::kDampingLost,     Reason::kBadDamping,
    Reason::kBadQuaternion, Reason::kSingularInertia, Reason::kBadMomentLength, Reason::kSpringWithoutDirection,
    Reason::kUncertain};

IslandReport island(Status status, Reason reason) {
  IslandReport report;
  report.status = status, report.reason = reason;
  return report;
}

TEST(Remedy, ExistsForEveryStatusAndReason) {
  for (const Reason reason : kReasons) {
    EXPECT_EQ(remedy(island(Status::kOk, reason)), "");
    for (const Status status : {Status::kRedundant, Status::kInconsistent, Status::kRegularised, Status::kFailed}) {
      const std::string text = remedy(island(status, reason));
      EXPECT_GT(text.size(), 20U) << to_string(status) << ", " << to_string(reason);
      EXPECT_EQ(text.back(), '.');
    }
  }
}

TEST(Remedy, DependsOnTheReason) {
  EXPECT_NE(remedy(island(Status::kFailed, Reason::kBadQuaternion)).find("quaternion"), std::string::npos);
  EXPECT_NE(remedy(island(Status::kFailed, Reason::kSingularInertia)).find("massless_joints"), std::string::npos);
  EXPECT_NE(remedy(island(Status::kRegularised, Reason::kDampingLost)).find("damping"), std::string::npos);
  EXPECT_NE(remedy(island(Status::kRedundant, Reason::kNone)).find("redistribute_forces"), std::string::npos);
}

TEST(Remedy, IsThatOfTheWorstIsland) {
  Report report;
  report.islands = {island(Status::kOk, Reason::kNone), island(Status::kFailed, Reason::kBadQuaternion),
                    island(Status::kRedundant, Reason::kNone)};
  summarise(report);
  EXPECT_EQ(remedy(report), remedy(report.islands[1]));
  EXPECT_EQ(remedy(Report{}), "");
}

}  // namespace
}  // namespace manycontact::test
