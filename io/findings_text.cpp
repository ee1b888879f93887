#include "io/findings_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/text.hpp"

namespace stickslip::io {
namespace {

struct OfTest {
  std::int64_t number;
  const base::Finding* finding;
};

/// "4–211", "3, 7, 9–12". \param numbers  in rising order where they are consecutive.
std::string ranges(std::span<const OfTest> tests) {
  std::string text;
  for (std::size_t i = 0; i < tests.size();) {
    std::size_t last = i;
    while (last + 1 < tests.size() && tests[last + 1].number == tests[last].number + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", tests[i].number);
    if (last > i) text += fmt::format("{}{}", last == i + 1 ? ", " : "–", tests[last].number);
    i = last + 1;
  }
  return text;
}

}  // namespace

std::string action_text(const base::Finding& finding) {
  return fmt::format("{}, {}: {}", base::printable(finding.code), base::name(finding.severity),
                     base::printable(finding.action));
}

std::string finding_text(const base::Finding& finding, std::string_view head) {
  return fmt::format("{}{}\n   → {}\n", head, base::printable(finding.text), action_text(finding));
}

std::string findings_text(std::span<const TestFindings> tests) {
  constexpr std::size_t kMostSentences = 3;
  std::vector<std::vector<OfTest>> groups;
  for (const TestFindings& test : tests) {
    for (const base::Finding& finding : test.findings) {
      const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
        return group.front().finding->code == finding.code;
      });
      (same == groups.end() ? groups.emplace_back() : *same).push_back({test.number, &finding});
    }
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return a.front().finding->severity > b.front().finding->severity;
  });
  std::string text;
  for (const std::vector<OfTest>& group : groups) {
    const base::Finding& first = *group.front().finding;
    const bool is_coded = first.code != base::kind_of(base::FindingCode::kUncoded).name;
    const std::size_t told = is_coded ? std::min(group.size(), kMostSentences) : group.size();
    for (const OfTest& one : std::span{group}.first(told))
      text += fmt::format("!  test {}: {}\n", one.number, base::printable(one.finding->text));
    if (const auto others = std::span{group}.subspan(told); !others.empty())
      text += fmt::format("   alike in {} more: test {}\n", others.size(), ranges(others));
    text += fmt::format("   → {}\n", action_text(first));
  }
  return text;
}

}  // namespace stickslip::io
