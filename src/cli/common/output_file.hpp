#pragma once
// Files that have their names when they are whole.

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace manycontact::cli {

/// What a link to a file means; links to open files in /proc, which may have no name any more, are not followed.
std::string behind_links(const std::string& path);
/// "-", /dev/stdout and whatever else leads to descriptor 1.
bool is_standard_output(const std::string& path);

/// The file of an option. It is called FILE.part until it is published: FILE is never half written, and an older one
/// stays until then. Several processes may write it, several runs may not. Standard output (-), what is there and is no
/// regular file (a device, a pipe), and open files by their names in /proc and /dev/fd are written straight; those of
/// this process go on where they are. Throws InputError where it cannot be written.
class PartFile {
 public:
  /// option: for the message; "" where there is none.
  explicit PartFile(std::string path, std::string option = "");
  /// Removes what was not published.
  ~PartFile();
  PartFile(PartFile&&) noexcept;
  PartFile(const PartFile&) = delete;

  bool is_straight() const { return part_ == target_; }
  const std::string& path() const { return path_; }
  /// Where the bytes go meanwhile.
  const std::string& part() const { return part_; }

  /// Opens it, empty.
  void create();
  /// Opens it in another process, once it was created.
  void join();
  void resize(std::int64_t bytes);
  void write(const char* bytes, std::size_t size);  // after what was written before
  void write_at(std::int64_t at, const char* bytes, std::size_t size);
  /// All that this process wrote is with the file system.
  void close();
  /// FILE.part becomes FILE: by one process, once all have closed it. The others leave it to that one.
  void publish();
  void leave() { unfinished_ = false; }

 private:
  void open(int flags);
  void open_again();  // what this process has open
  bool take();        // FILE.part for this run; false where another one has just given it up
  template <class Put>
  void put(const char* bytes, std::size_t size, Put&& put_some);
  [[noreturn]] void refuse(const std::string& reason) const;
  [[noreturn]] void refuse(int error) const;

  std::string path_, option_, target_, part_;
  int file_ = -1, lock_ = -1;  // lock_: FILE.part too, until it has its name
  bool unfinished_ = false;
};

/// A PartFile written from its beginning to its end. Errors come out of the stream's operators, as InputError.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path, const std::string& option = "");
  std::ostream& stream() { return stream_; }
  /// It is whole: it has its name.
  void close();

 private:
  class Buffer final : public std::streambuf {
   public:
    explicit Buffer(PartFile& file) : file_(file), bytes_(1 << 16) {
      setp(bytes_.data(), bytes_.data() + bytes_.size());
    }

   private:
    int_type overflow(int_type c) override;
    int sync() override;

    PartFile& file_;
    std::vector<char> bytes_;
  };

  PartFile file_;
  Buffer buffer_;
  std::ostream stream_;
};

}  // namespace manycontact::cli
