#include "retalho/core/error.h"

namespace retalho {

const char* kind_name(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::internal:
      return "internal";
    case Error::Kind::usage:
      return "usage";
    case Error::Kind::bad_input:
      return "bad_input";
    case Error::Kind::cannot_read:
      return "cannot_read";
    case Error::Kind::cannot_write:
      return "cannot_write";
    case Error::Kind::interrupted:
      return "interrupted";
  }
  return "internal";
}

}  // namespace retalho
