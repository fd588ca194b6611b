#pragma once
/// Result folders that are either the old ones or the new ones, never half, also when the program
/// is killed while it writes.
///
/// A folder is written under a temporary name beside its target, flushed to the disk and exchanged with the
/// target in one step (renameat2 with RENAME_EXCHANGE; where the file system lacks it, two renames, and the
/// next run repairs an interruption between them). The names written are listed with a checksum in a file
/// `.volcal` inside (`.volcal-init` for files to be edited); files that the user put into the folder are
/// carried over, and a folder that holds files but no such list is never replaced.

#include <string>
#include <vector>

#include "volcal/identify/text/table_text.h"
#include "volcal/identify/text/temporary_paths.h"

namespace volcal {

/// What may stand where a folder is to be written.
enum class Replaceable {
  Results,   ///< nothing, or a folder that a command wrote to be read
  Unedited,  ///< that, or files to be edited; none of them has been edited since
  Anything,  ///< any folder: files of the same names are overwritten, others stay
};

class AtomicFolder {
 public:
  /// Creates the temporary folder and removes those of killed runs. Throws InputError when the target cannot
  /// be written or replaced: a file, a foreign folder, the current directory or one above it.
  explicit AtomicFolder(const std::string& target, Replaceable replaceable = Replaceable::Results);
  /// Removes what was written unless commit() was reached.
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  const std::string& target() const { return target_; }
  /// The temporary folder; anything written below it belongs to the result.
  const std::string& path() const { return temporary_; }
  std::string path(const std::string& name) const { return temporary_ + "/" + name; }
  /// Writes one file.
  void write(const std::string& name, const std::string& content) const;
  void write(const TableFile& file) const;
  /// Puts the folder in the place of the target. Throws InputError when the system refuses.
  void commit();
  /// The same for files that the user is to edit: nothing replaces the folder that does not look for edits.
  void commit_to_be_edited();

 private:
  void create_temporary();
  void carry_over_user_files() const;
  void write_list(const char* name) const;
  void put_in_place(const char* list);
  void exchange() const;

  std::string target_;
  std::string temporary_;
  TemporaryPath known_temporary_;
  int lock_ = -1;
  bool committed_ = false;
};

/// Throws what AtomicFolder would throw for this target, before a long computation is lost to it, and where
/// the folder is, or holds, one of `inputs` (files or folders; empty ones do not count), which replacing it
/// would delete. Writes nothing.
void require_output_folder(const std::string& target, const std::vector<std::string>& inputs = {},
                           Replaceable replaceable = Replaceable::Results);

}  // namespace volcal
