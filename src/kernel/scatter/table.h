// Where to look in the table of mean forward attenuation a_f(cos theta, sigma_a) (frame/dual_scattering_tables.h): the
// caller fetches four neighbors, each target in its own way. One scalar table serves every color, strand and channel.

const float kScatterTableRows = 65.0f;           // cos theta = row/(rows - 1)
const float kScatterTableColumns = 65.0f;        // e^(-sigma_a/2) = column/(columns - 1)
const float kScatterTableMaxAbsError = 2.0e-3f;  // of a_f, against adaptive quadrature; everywhere but cos theta < 0.02

struct ScatterTableCell {
  Float index;  // of the corner (row, column) in row-major order: a whole number
  Float row;    // weights of the next row and the next column, [0, 1]
  Float column;
};

PELAGE_FN ScatterTableCell scatter_table_cell(Float cos_theta, Float sigma_a) {
  ScatterTableCell c;
  Float y = v_clamp(cos_theta, Float(0.0f), Float(1.0f)) * Float(kScatterTableRows - 1.0f);
  Float x = m_exp(Float(-0.5f) * max(sigma_a, Float(0.0f))) * Float(kScatterTableColumns - 1.0f);
  Float row = min(floor(y), Float(kScatterTableRows - 2.0f));
  Float column = min(floor(x), Float(kScatterTableColumns - 2.0f));
  c.index = row * Float(kScatterTableColumns) + column;
  c.row = y - row;
  c.column = x - column;
  return c;
}
// Bilinear: values at index, index + 1, index + columns, index + columns + 1.
PELAGE_FN Float scatter_table_mix(ScatterTableCell c, Float v00, Float v01, Float v10, Float v11) {
  Float a = v00 + (v01 - v00) * c.column;
  Float b = v10 + (v11 - v10) * c.column;
  return a + (b - a) * c.row;
}
