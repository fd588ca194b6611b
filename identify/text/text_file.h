#pragma once
/// Whole text files, with the errors a user can mend: missing, a directory, a pipe or device, empty, binary,
/// UTF-16, lines that end in CR alone.

#include <optional>
#include <string>

#include "volcal/identify/text/text_encoding.h"
#include "volcal/model/description/errors.h"

namespace volcal {

/// Content of a text file without its UTF-8 byte order mark. `named_at` is the line that names the file (a
/// campaign's `data` key); errors about a missing file are reported there, or at the file itself when empty.
/// Throws InputError.
std::string read_text_file(const std::string& path, const SourcePlace& named_at = {});

/// In which encoding a file is.
struct FileEncoding {
  TextEncoding encoding = TextEncoding::Utf8;
  bool only_if_not_utf8 = false;  ///< a file that is UTF-8 is read as it is
};
/// The same of a file in any encoding, as UTF-8; bytes that the encoding leaves open are U+FFFD.
std::string read_text_file(const std::string& path, const FileEncoding& encoding,
                           const SourcePlace& named_at);

/// A file of foreign origin, as UTF-8: in the encoding named; without a name UTF-8, or UTF-16 by its byte
/// order mark. Throws InputError at the line of the first byte that the encoding leaves open; `option` is
/// what names an encoding, as "--encoding ".
std::string read_foreign_text(const std::string& path, std::optional<TextEncoding> encoding,
                              const std::string& option);
/// The same of bytes that were read from `file`.
std::string foreign_text(const std::string& bytes, const std::string& file,
                         std::optional<TextEncoding> encoding, const std::string& option);

/// Throws InputError unless `path` leads to a regular file, also through links. A pipe is none, and opening
/// one that nobody writes to would wait for ever. `named_at` as above.
void require_file(const std::string& path, const SourcePlace& named_at = {});

/// Writes under a temporary name and renames: a killed program leaves the old file or the new one. Throws
/// InputError.
void write_text_file(const std::string& path, const std::string& text);

/// Throws InputError when `text` cannot be a text file of lines (NUL bytes, UTF-16, lines that end in CR
/// alone); `file` names it in the message.
void require_text(const std::string& text, const std::string& file);

/// What to do about a file or folder that does not exist: the name meant, the folder that is missing too, or
/// `otherwise`.
std::string missing_remedy(const std::string& path, const std::string& otherwise);

/// Path that `file` names in a line of `from`: relative paths count from the folder of `from`.
std::string resolve_path(const std::string& from, const std::string& file);

/// Both paths lead to one file that exists.
bool same_file(const std::string& one, const std::string& other);

/// A name or a value from a file as it may appear in a message: one line, printable, not longer than 60
/// characters.
std::string printable(const std::string& text);
/// A number as it appears in a message, with at most `digits` significant digits.
std::string number_text(double value, int digits = 6);

}  // namespace volcal
