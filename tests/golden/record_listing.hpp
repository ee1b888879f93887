/// \file
/// Compares a record in memory with what h5py read in its file when that was frozen
/// (tests/golden/list_record.py).
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/record/fields.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::test {

/// Every look is remembered: what nobody looked at is what the reader lost.
class RecordListing {
 public:
  explicit RecordListing(const std::filesystem::path& file) {
    std::ifstream stream{file};
    if (!stream) throw std::runtime_error(file.string() + " cannot be read");
    listing_ = nlohmann::json::parse(stream);
  }

  [[nodiscard]] std::int64_t version() const { return listing_.at("root").at("format_version"); }
  [[nodiscard]] bool has(const std::string& name) const { return datasets().contains(name); }

  /// Empty stands for absent, as in the record.
  void expect_text(const std::string& name, const std::string& text) {
    if (text.empty() && !has(name)) return;
    EXPECT_EQ(at(name).value("value", nlohmann::json{}), text) << name;
  }
  void expect_texts(const std::string& name, const std::vector<std::string>& texts) {
    EXPECT_EQ(at(name).value("texts", nlohmann::json{}), texts) << name;
  }
  void expect_number(const std::string& name, std::string_view unit, const nlohmann::json& number) {
    EXPECT_EQ(at(name).value("value", nlohmann::json{}), plain(number)) << name;
    expect_attribute(name, "units", unit);
  }
  /// Null stands for absent.
  void expect_attribute(const std::string& name, const char* attribute, const nlohmann::json& value) {
    EXPECT_EQ(at(name).value(attribute, nlohmann::json{}), plain(value)) << name << "@" << attribute;
  }
  /// \tparam T  the type in the file.
  template <typename T>
  void expect_column(const std::string& name, std::string_view unit, const std::vector<T>& values) {
    const nlohmann::json entry = at(name);
    EXPECT_EQ(entry.value("rows", std::size_t{0}), values.size()) << name;
    record::Sha256 sha;
    sha.add(std::span<const T>{values});
    EXPECT_EQ(entry.value("sha256", std::string{}), sha.hexadecimal()) << name;
    EXPECT_EQ(entry.value("units", std::string{}), unit) << name;
  }
  /// It is there, whatever it says.
  void look_at(const std::string& name) { static_cast<void>(at(name)); }
  void expect_absent(const std::string& name) const { EXPECT_FALSE(has(name)) << name; }

  [[nodiscard]] std::vector<std::string> not_looked_at() const {
    std::vector<std::string> rest;
    for (const auto& [name, entry] : datasets().items()) {
      if (!seen_.contains(name)) rest.push_back(name);
    }
    return rest;
  }

 private:
  [[nodiscard]] const nlohmann::json& datasets() const { return listing_.at("datasets"); }
  [[nodiscard]] nlohmann::json at(const std::string& name) {
    seen_.insert(name);
    if (has(name)) return datasets().at(name);
    ADD_FAILURE() << name << " is read but was never written";
    return nlohmann::json::object();
  }
  /// JSON has no word for what is not a number.
  [[nodiscard]] static nlohmann::json plain(const nlohmann::json& value) {
    if (value.is_number_float() && std::isnan(value.get<double>())) return "nan";
    return value;
  }

  nlohmann::json listing_;
  std::set<std::string> seen_;
};

/// Visitor for record::for_each_field().
class ListedFields {
 public:
  ListedFields(RecordListing& listing, std::string group) : listing_(listing), group_(std::move(group)) {}

  void operator()(const record::FieldName& name, const std::string& text) const {
    listing_.expect_text(path(name), text);
  }
  void operator()(const record::FieldName& name, const std::vector<double>& values) const {
    if (values.empty()) return listing_.expect_absent(path(name));
    listing_.expect_column(path(name), name.unit, values);
  }
  void operator()(const record::FieldName& name, const std::vector<std::string>& texts) const {
    if (texts.empty()) return listing_.expect_absent(path(name));
    listing_.expect_texts(path(name), texts);
  }
  template <typename T>
  void operator()(const record::FieldName& name, const std::optional<T>& value) const {
    if (value) {
      listing_.expect_number(path(name), name.unit, *value);
    } else {
      listing_.expect_absent(path(name));
    }
  }
  template <typename T>
  void operator()(const record::FieldName& name, const T& value) const {
    listing_.expect_number(path(name), name.unit, value);
  }

 private:
  [[nodiscard]] std::string path(const record::FieldName& name) const {
    return group_ + "/" + std::string{name.name};
  }

  RecordListing& listing_;
  std::string group_;
};

}  // namespace stickslip::test
