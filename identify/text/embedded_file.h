#pragma once
/// A file of the build inside the program.

/// Between NAME_begin and NAME_end, bytes as they are; FILE is a literal, its path. At global scope. The
/// assembler copies it in: a two-megabyte array in C++ would take the compiler many seconds.
// clang-format off
#define VOLCAL_EMBED_FILE(NAME, FILE)                                                              \
  asm(".pushsection .rodata\n"                                                                     \
      ".balign 16\n"                                                                               \
      ".hidden " #NAME "_begin\n.hidden " #NAME "_end\n"                                           \
      ".global " #NAME "_begin\n.global " #NAME "_end\n"                                           \
      #NAME "_begin:\n"                                                                            \
      ".incbin \"" FILE "\"\n"                                                                     \
      #NAME "_end:\n"                                                                              \
      ".byte 0\n"                                                                                  \
      ".popsection\n");                                                                            \
  extern "C" const char NAME##_begin[];                                                            \
  extern "C" const char NAME##_end[]
// clang-format on
