// A rectangle of a grid's cells.
#pragma once

namespace retalho {

struct CellWindow {
  int column = 0, row = 0;    ///< of the north-western cell
  int columns = 0, rows = 0;  ///< how many
  friend bool operator==(const CellWindow&, const CellWindow&) = default;
};

}  // namespace retalho
