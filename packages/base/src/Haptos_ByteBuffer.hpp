// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <Teuchos_Assert.hpp>

namespace Haptos {

using Bytes = std::vector<char>;

/// \brief Writes values one after the other, to be sent to another rank.
///
/// A value is plain bytes, a string, a vector of values, or a class whose `parts()` gives references to all that it is made
/// of: `auto parts() { return std::tie(name, nodes); }`.
class ByteWriter {
 public:
  template <class T>
  void write(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) append(&value, sizeof(T));
    else std::apply([&](const auto&... part) { (write(part), ...); }, const_cast<T&>(value).parts());  // read only
  }
  template <class T>
  void write(const std::vector<T>& values) {
    write(values.size());
    writeAll(values);
  }
  void write(const std::string& text) { write(std::vector<char>(text.begin(), text.end())); }

  /// Without their number: `ByteReader::readAll` goes on to the end.
  template <class T>
  void writeAll(const std::vector<T>& values) {
    if constexpr (std::is_trivially_copyable_v<T>) append(values.data(), values.size() * sizeof(T));
    else
      for (const T& value : values) write(value);
  }

  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* values, std::size_t size) {
    if (size == 0) return;  // `values` may be null
    const char* p = static_cast<const char*>(values);
    bytes_.insert(bytes_.end(), p, p + size);
  }

  Bytes bytes_;
};

/// \brief Reads back, in the same order, what a ByteWriter wrote.
class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes) : bytes_(&bytes) {}

  template <class T>
  T read() {
    T value;
    readInto(value);
    return value;
  }
  template <class T>
  std::vector<T> readVector() {
    return read<std::vector<T>>();
  }
  std::string readString() { return read<std::string>(); }

  /// Appends all that is left.
  template <class T>
  void readAll(std::vector<T>& values) {
    if constexpr (std::is_trivially_copyable_v<T>) append(values, (bytes_->size() - position_) / sizeof(T));
    else
      while (!atEnd()) values.push_back(read<T>());
  }
  bool atEnd() const { return position_ == bytes_->size(); }

 private:
  template <class T>
  void readInto(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) copyOut(&value, sizeof(T));
    else std::apply([&](auto&... part) { (readInto(part), ...); }, value.parts());
  }
  template <class T>
  void readInto(std::vector<T>& values) {
    const auto size = read<std::size_t>();
    values.clear();
    if constexpr (std::is_trivially_copyable_v<T>) append(values, size);
    else
      while (values.size() < size) values.push_back(read<T>());
  }
  void readInto(std::string& text) {
    const auto chars = readVector<char>();
    text.assign(chars.begin(), chars.end());
  }
  template <class T>
  void append(std::vector<T>& values, std::size_t count) {
    values.resize(values.size() + count);
    copyOut(values.data() + values.size() - count, count * sizeof(T));
  }
  void copyOut(void* target, std::size_t size) {
    TEUCHOS_ASSERT(position_ + size <= bytes_->size());
    if (size > 0) std::memcpy(target, bytes_->data() + position_, size);
    position_ += size;
  }

  const Bytes* bytes_;
  std::size_t position_ = 0;
};

}  // namespace Haptos
