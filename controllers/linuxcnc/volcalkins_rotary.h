/* Rotary axes of volcalkins: the file volcal.rotary and the corrections that it holds. Part of volcalkins.c,
 * which includes it; the same licence.
 *
 * Copyright 2026 The volcal authors
 * SPDX-License-Identifier: GPL-2.0-or-later
 */
#define MOST_JOINTS 6
#define MOST_BODIES 2 /* table, tool */
#define MOST_POSITIONS 100000
#define DEGREE (M_PI / 180.0)
#define SAME_NODE 1e-9 /* degrees */

/* From volcal.rotary: the chain from workpiece to tool, and what corrects its rotary axes. */
static struct {
  int joints;
  int axis[MOST_JOINTS]; /* 0..5, in the order of the chain */
  int table;             /* so many of them are on the workpiece side */
  double centre[ALL_AXES][3];
  double tool[3];
} chain;

struct own_table { /* added to the axis' own command, degrees */
  int size;
  double *position, *plus, *minus;
  int full_turn;
};
static struct own_table own[ALL_AXES];

struct twist_grid {
  int axes, axis[2]; /* the second one fastest */
  int size[2], full_turn[2];
  double *node[2];
  double (*value)[6]; /* machine units, rad */
  double reference[3];
  int carrier; /* joints of the chain before it carry or are turned by the table; -1 = no grid */
};
static struct twist_grid twists[MOST_BODIES]; /* table, tool */

/* ---- the file of rotary axes ---- */

static int axis_of(char letter) {
  const char *place = letter == '\0' ? NULL : strchr("XYZABC", letter);
  return place == NULL ? -1 : (int)(place - "XYZABC");
}

/* "C' A' b X Y Z": a quote behind what stands on the workpiece side. */
static int read_chain(const char *text) {
  int linear = 0, left = 0; /* the linear axes, and whether a rotary one has come behind them */
  for (; *text != '\0'; ++text) {
    const int i = axis_of(*text);
    if (strchr(" \t\r\nb'", *text) != NULL) continue;
    if (i < 0 || chain.joints == MOST_JOINTS) return fail("the chain has a letter that is no axis");
    if (i < AXES && left) return fail("a rotary axis stands between linear axes");
    if (i < AXES) ++linear;
    if (i >= AXES && linear > 0) left = 1;
    if (text[1] == '\'') ++chain.table;
    chain.axis[chain.joints++] = i;
  }
  return linear == AXES ? 0 : fail("the chain needs X, Y and Z");
}

static int numbers_of(const char *line, double *number, int most) {
  char *end;
  int count = 0;
  for (; count < most; ++count) {
    number[count] = strtod(line, &end);
    if (end == line || !isfinite(number[count])) break;
    line = end;
  }
  return line[strspn(line, " \t\r\n")] == '\0' ? count : -1;
}

static int read_three(const char *text, double *value) {
  return numbers_of(text, value, 3) == 3 ? 0 : fail("three numbers are needed");
}

/* own A ROWS TURN, then ROWS lines: position, towards +, towards -; degrees. */
static int read_own(FILE *file, const char *text) {
  char letter, line[LONGEST_LINE];
  double number[3];
  struct own_table *table;
  int i, size, turn;
  if (sscanf(text, " %c %d %d", &letter, &size, &turn) != 3 || axis_of(letter) < AXES || size < 1 ||
      size > MOST_POSITIONS)
    return fail("write own A ROWS TURN");
  table = &own[axis_of(letter)];
  if (table->size > 0) return fail("the axis has a second table");
  table->position = calloc(3 * (size_t)size, sizeof(double));
  if (table->position == NULL) return -ENOMEM;
  table->plus = table->position + size;
  table->minus = table->plus + size;
  for (i = 0; i < size; ++i) {
    if (!next_line(file, line) || numbers_of(line, number, 3) != 3)
      return fail("the row does not have 3 numbers");
    if (i > 0 && !(number[0] > table->position[i - 1])) return fail("positions do not ascend");
    table->position[i] = number[0];
    table->plus[i] = number[1];
    table->minus[i] = number[2];
  }
  if (turn && fabs(table->position[size - 1] - table->position[0] - 360.0) > 1e-6)
    return fail("the positions do not make a turn");
  table->full_turn = turn;
  table->size = size;
  return 0;
}

/* twists table|tool A ROWS TURN [C ROWS TURN], a line with the reference point, then the rows: positions,
 * three displacements, three rotations. */
static int read_twists(FILE *file, const char *text) {
  char body[8], letter[2] = {0, 0}, line[LONGEST_LINE];
  double number[8];
  struct twist_grid *g;
  long rows, row;
  int k;
  g = &twists[strncmp(text, " tool", 5) == 0];
  if (g->axes > 0) return fail("the body has a second grid");
  g->size[1] = 1;
  k = sscanf(text, " %7s %c %d %d %c %d %d", body, &letter[0], &g->size[0], &g->full_turn[0], &letter[1],
             &g->size[1], &g->full_turn[1]);
  if ((k != 4 && k != 7) || (strcmp(body, "table") != 0 && strcmp(body, "tool") != 0))
    return fail("write twists table A ROWS TURN C ROWS TURN");
  g->axes = k == 7 ? 2 : 1;
  for (k = 0; k < g->axes; ++k) {
    g->axis[k] = axis_of(letter[k]);
    if (g->axis[k] < AXES || g->size[k] < 1 || g->size[k] > MOST_POSITIONS)
      return fail("the size is out of range");
    g->node[k] = calloc(g->size[k], sizeof(double));
    if (g->node[k] == NULL) return -ENOMEM;
  }
  rows = (long)g->size[0] * g->size[1];
  if (rows > MOST_NODES) return fail("the grid is too large");
  g->value = calloc(rows, sizeof(*g->value));
  if (g->value == NULL) return -ENOMEM;
  if (!next_line(file, line)) return fail("the reference point is missing");
  if (read_three(line, g->reference) != 0) return -EINVAL;
  for (row = 0; row < rows; ++row) {
    const int index[2] = {(int)(row / g->size[1]), (int)(row % g->size[1])};
    if (!next_line(file, line) || numbers_of(line, number, g->axes + 6) != g->axes + 6)
      return fail("the row does not have the numbers of its grid");
    for (k = 0; k < g->axes; ++k) {
      if (index[1 - k] == 0 || g->axes == 1) {
        if (index[k] > 0 && !(number[k] > g->node[k][index[k] - 1])) return fail("positions do not ascend");
        g->node[k][index[k]] = number[k];
      } else if (number[k] != g->node[k][index[k]]) {
        return fail("the rows are no complete grid, the last axis fastest");
      }
    }
    memcpy(g->value[row], number + g->axes, sizeof(*g->value));
  }
  for (k = 0; k < g->axes; ++k)
    if (g->full_turn[k] && fabs(g->node[k][g->size[k] - 1] - g->node[k][0] - 360.0) > 1e-6)
      return fail("the positions do not make a turn");
  return 0;
}

/* Joints of the chain that stand between the workpiece and the body that carries the axes of a grid: those
 * up to the last of its axes on the side of the table, those before the first on the side of the tool. */
static int carrier_of(const struct twist_grid *g, int tool) {
  int i, k, place = tool ? chain.joints : 0;
  for (i = chain.joints - 1; i >= 0; --i) {
    for (k = 0; k < g->axes; ++k) {
      if (g->axis[k] != chain.axis[i]) continue;
      if ((i < chain.table) == tool) return -1; /* the axis turns the other body */
      if (tool) place = i;
      if (!tool && i + 1 > place) place = i + 1;
    }
  }
  return place;
}

static int place_grids(void) {
  int body, k, i;
  for (body = 0; body < MOST_BODIES; ++body) {
    struct twist_grid *g = &twists[body];
    for (k = 0; k < g->axes; ++k) {
      for (i = 0; i < chain.joints && chain.axis[i] != g->axis[k]; ++i) {
      }
      if (i == chain.joints) return fail("an axis of a grid is not in the chain");
    }
    g->carrier = g->axes > 0 ? carrier_of(g, body) : -1;
    if (g->axes > 0 && g->carrier < 0) return fail("an axis of a grid turns the other body");
  }
  return 0;
}

static int read_rotary(void) {
  char line[LONGEST_LINE], unit[8], letter;
  int result = 0, offset;
  FILE *file;
  twists[0].carrier = twists[1].carrier = -1;
  if (rotary[0] == '\0') return 0;
  file_name = rotary;
  line_number = 0;
  file = fopen(rotary, "r");
  if (file == NULL) return fail("cannot be opened");
  if (!next_line(file, line) || sscanf(line, "volcal-rotary-1 %7s", unit) != 1)
    result = fail("the header is not volcal-rotary-1 UNIT");
  while (result == 0 && next_line(file, line)) {
    offset = 0;
    if (strncmp(line, "chain ", 6) == 0) {
      result = chain.joints > 0 ? fail("there is a second chain") : read_chain(line + 6);
    } else if (sscanf(line, "centre %c%n", &letter, &offset) == 1 && axis_of(letter) >= AXES) {
      result = read_three(line + offset, chain.centre[axis_of(letter)]);
    } else if (strncmp(line, "tool ", 5) == 0) {
      result = read_three(line + 5, chain.tool);
    } else if (strncmp(line, "own ", 4) == 0) {
      result = read_own(file, line + 3);
    } else if (strncmp(line, "twists ", 7) == 0) {
      result = read_twists(file, line + 6);
    } else {
      result = fail("the line is neither chain, centre, tool, own nor twists");
    }
  }
  fclose(file);
  if (result == 0 && chain.joints == 0) result = fail("the chain is missing");
  return result == 0 ? place_grids() : result;
}

/* ---- the corrections ---- */

/* Of a rotary axis; modulo a turn where the nodes make one. */
static int turned_piece_of(const double *node, int size, int full_turn, double position, double *along) {
  if (full_turn) position -= 360.0 * floor((position - node[0] + SAME_NODE) / 360.0);
  return piece_of(node, size, position, along);
}

static double own_correction(int i, double position) {
  const struct own_table *table = &own[i];
  double along, plus, minus;
  int lower, upper;
  if (table->size == 0) return 0.0;
  lower = turned_piece_of(table->position, table->size, table->full_turn, position, &along);
  upper = lower + (table->size > 1);
  plus = table->plus[lower] + along * (table->plus[upper] - table->plus[lower]);
  minus = table->minus[lower] + along * (table->minus[upper] - table->minus[lower]);
  return 0.5 * (plus + minus) + 0.5 * axis[i].share * (plus - minus);
}

static void twist_at(const struct twist_grid *g, const double *position, double *twist) {
  int lower[2] = {0, 0}, corner, k, i;
  double along[2] = {0.0, 0.0};
  for (k = 0; k < g->axes; ++k)
    lower[k] = turned_piece_of(g->node[k], g->size[k], g->full_turn[k], position[g->axis[k]], &along[k]);
  for (i = 0; i < 6; ++i) twist[i] = 0.0;
  for (corner = 0; corner < 4; ++corner) {
    double weight = 1.0;
    long row = 0;
    for (k = 0; k < 2; ++k) {
      const int upper = (corner >> k) & 1;
      weight *= upper ? along[k] : 1.0 - along[k];
      row = row * g->size[k] + lower[k] + upper;
    }
    if (weight == 0.0) continue;
    for (i = 0; i < 6; ++i) twist[i] += weight * g->value[row][i];
  }
}

/* The vector turned about a coordinate axis. */
static void turn(int about, double angle, double *v) {
  const int j = (about + 1) % 3, k = (about + 2) % 3;
  const double c = cos(angle), s = sin(angle), old = v[j];
  v[j] = c * old - s * v[k];
  v[k] = s * old + c * v[k];
}

/* Nominal joints of the chain from `last` - 1 down to `first`, of a point, or of a direction. */
static void through_joints(int first, int last, const double *position, int point, double *v) {
  int i, k;
  for (i = last - 1; i >= first; --i) {
    const int a = chain.axis[i];
    if (a < AXES) {
      if (point) v[a] += position[a];
      continue;
    }
    for (k = 0; point && k < 3; ++k) v[k] -= chain.centre[a][k];
    turn(a - AXES, position[a] * DEGREE, v);
    for (k = 0; point && k < 3; ++k) v[k] += chain.centre[a][k];
  }
}

/* Moves of the linear axes: displacement in the workpiece, then along the directions that they have there,
 * which no rotary axis between them bends. */
static void twist_correction(const double *position, double *sum) {
  int body, i, k, first_linear = 0;
  while (first_linear < chain.joints && chain.axis[first_linear] >= AXES) ++first_linear;
  for (body = 0; body < MOST_BODIES; ++body) {
    const struct twist_grid *g = &twists[body];
    double twist[6], x[3], d[3];
    if (g->carrier < 0) continue;
    twist_at(g, position, twist);
    for (k = 0; k < 3; ++k) x[k] = chain.tool[k];
    through_joints(g->carrier, chain.joints, position, 1, x);
    for (k = 0; k < 3; ++k) x[k] -= g->reference[k];
    for (k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      d[k] = twist[k] + twist[3 + l] * x[m] - twist[3 + m] * x[l];
    }
    through_joints(0, g->carrier, position, 0, d);
    for (i = 0; i < AXES; ++i) {
      double direction[3] = {0.0, 0.0, 0.0};
      direction[i] = 1.0;
      through_joints(0, first_linear, position, 0, direction);
      for (k = 0; k < 3; ++k) sum[i] += direction[k] * d[k];
    }
  }
}
