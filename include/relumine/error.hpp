// SPDX-License-Identifier: Apache-2.0
// The errors that the library throws: every message says where, what was expected and what was found.
#pragma once

#include <stdexcept>
#include <string>

namespace relumine {

/// Base of everything that the library throws on purpose. `what()` is one line, ready to be shown to a
/// person.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// An input file cannot be used. `what()` is "file[:line[:column]][: place]: expected …, found …".
class FileError : public Error {
  public:
    using Error::Error;
};

/// A scene file, or a scene built in memory, is not valid.
class SceneError : public FileError {
  public:
    using FileError::FileError;
};

/// A picture file is not valid, or its pixels cannot be used.
class ImageError : public FileError {
  public:
    using FileError::FileError;
};

/// A setting is out of its range, names something that does not exist, or contradicts another one.
class SettingsError : public Error {
  public:
    using Error::Error;
};

/// A file could not be written. What stood under its name before is untouched.
class OutputError : public Error {
  public:
    using Error::Error;
};

}  // namespace relumine
