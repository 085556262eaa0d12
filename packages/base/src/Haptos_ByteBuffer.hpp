// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <Teuchos_Assert.hpp>

namespace Haptos {

/// \brief Writes plain values and vectors of them one after the other, to be sent to another rank.
class ByteWriter {
 public:
  template <class T>
  void write(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const char* p = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), p, p + sizeof(T));
  }
  template <class T>
  void write(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(values.size());
    const char* p = reinterpret_cast<const char*>(values.data());
    bytes_.insert(bytes_.end(), p, p + values.size() * sizeof(T));
  }
  void write(const std::string& text) { write(std::vector<char>(text.begin(), text.end())); }

  std::vector<char> take() { return std::move(bytes_); }

 private:
  std::vector<char> bytes_;
};

/// \brief Reads back, in the same order, what a ByteWriter wrote.
class ByteReader {
 public:
  explicit ByteReader(const std::vector<char>& bytes) : bytes_(&bytes) {}

  template <class T>
  T read() {
    T value;
    copyOut(&value, sizeof(T));
    return value;
  }
  template <class T>
  std::vector<T> readVector() {
    std::vector<T> values(read<std::size_t>());
    copyOut(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string readString() {
    const auto chars = readVector<char>();
    return std::string(chars.begin(), chars.end());
  }
  bool atEnd() const { return position_ == bytes_->size(); }

 private:
  void copyOut(void* target, std::size_t size) {
    TEUCHOS_ASSERT(position_ + size <= bytes_->size());
    if (size > 0) std::memcpy(target, bytes_->data() + position_, size);
    position_ += size;
  }

  const std::vector<char>* bytes_;
  std::size_t position_ = 0;
};

}  // namespace Haptos
