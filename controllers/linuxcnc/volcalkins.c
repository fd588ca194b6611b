/* volcalkins: LinuxCNC kinematics of a machine with linear axes X Y Z, rotary axes of the table or of the
 * head, and volumetric compensation.
 *
 * Copyright 2026 The volcal authors
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * This file and volcalkins_rotary.h alone of volcal are under the GNU General Public License, version 2 or
 * (at your option) any later version: they are compiled against headers of LinuxCNC and loaded into it, which
 * are under the GPL. They come WITHOUT ANY WARRANTY. The licence:
 * https://www.gnu.org/licenses/old-licenses/gpl-2.0.html
 *
 *   joint = axis + correction(axis, direction)        joints 0 1 2 = X Y Z, then the rotary axes
 *
 * Programs are in axis positions, as with trivkins: the module adds corrections and no tool centre point
 * motion. Without a file of rotary axes, joints 3 4 5 are A B C, unchanged; with it, the joints from 3 on are
 * those of A B C that the machine has, in this order.
 *
 * The correction comes from a file of `volcal tables --format linuxcnc-grid`: trilinear between the nodes,
 * held beyond them. In every servo period the function volcalkins.directions looks which way each axis was
 * commanded last and takes that half of its reversal, over RAMP_SECONDS so that no joint jumps. Until it
 * moves after homing an axis counts as approached towards +, where the tables are zero at home. Without this
 * function the mean of both directions is applied.
 *
 * A second file, rotary=/path/to/volcal.rotary, holds errors of rotary axes: what is added to the command of
 * each (degrees, a row per position, towards + and towards -), and rigid twists of table and tool over the
 * positions of the rotary axes of that side, linear between them. With x the nominal functional point of the
 * tool in the file, in the body that carries these axes, the linear axes move by displacement + rotation
 * x (x - reference), turned into their directions. A rotary axis that stands between two linear ones is
 * refused.
 *
 *   loadrt volcalkins grid=/path/to/volcal.grid rotary=/path/to/volcal.rotary
 *   addf volcalkins.directions servo-thread           (before motion-controller)
 *   net volcal-x axis.x.pos-cmd => volcalkins.x       (and y, z; a, b, c where the machine has them)
 *   net volcal-homed motion.is-all-homed => volcalkins.homed
 *
 * Build and install, volcalkins_rotary.h beside it: halcompile --install volcalkins.c
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal.h"
#include "kinematics.h"
#include "rtapi.h"
#include "rtapi_app.h"

MODULE_AUTHOR("The volcal authors");
MODULE_DESCRIPTION("X Y Z A B C kinematics with volumetric compensation");
MODULE_LICENSE("GPL");

static char *grid = "volcal.grid";
RTAPI_MP_STRING(grid, "file of volcal tables --format linuxcnc-grid, in LINEAR_UNITS");

static char *rotary = "";
RTAPI_MP_STRING(rotary, "file of volcal tables --format linuxcnc-grid with rotary axes; empty = none");

KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

#define AXES 3
#define ALL_AXES 6     /* X Y Z A B C */
#define NODE_VALUES 12 /* mean, then half the reversal of X, Y, Z; each dx dy dz */
#define ROW_VALUES (AXES + NODE_VALUES)
#define MOST_NODES 1000000
#define LONGEST_LINE 1024
#define RAMP_SECONDS 0.1 /* from one direction to the other */
#define TURNED_BY 1e-6   /* back from the farthest position, machine units: a reversal */
#define HOMING_PERIODS 10
#define FORWARD_ACCURACY 1e-10 /* machine units */
#define FORWARD_STEPS 50

static int component;

static struct {
  int size[AXES];
  double *node[AXES];
  double (*value)[NODE_VALUES]; /* Z fastest */
} map;

static struct {
  hal_float_t **position; /* pin: commanded */
  double farthest;        /* in the present direction */
  int direction;          /* +1, -1 */
  double share;           /* of half the reversal, from -1 to +1 */
} axis[ALL_AXES];

static struct {
  hal_bit_t **pin;
  int periods; /* since homing; the first ones do not count, positions jump in them */
} homed;

/* ---- the files ---- */

static const char *file_name;
static int line_number;

static int fail(const char *problem) {
  rtapi_print_msg(RTAPI_MSG_ERR, "volcalkins: %s:%d: %s\n", file_name, line_number, problem);
  return -EINVAL;
}

/* The next line that is neither empty nor a comment. */
static int next_line(FILE *file, char *line) {
  while (fgets(line, LONGEST_LINE, file) != NULL) {
    ++line_number;
    if (line[strspn(line, " \t\r\n")] != '\0' && line[0] != '#') return 1;
  }
  return 0;
}

static int read_header(FILE *file) {
  char line[LONGEST_LINE], unit[8];
  long nodes = 1;
  int i;
  if (!next_line(file, line) ||
      sscanf(line, "volcal-grid-1 %7s %d %d %d", unit, &map.size[0], &map.size[1], &map.size[2]) != 4)
    return fail("the header is not volcal-grid-1 UNIT NX NY NZ");
  for (i = 0; i < AXES; ++i) {
    if (map.size[i] < 1 || map.size[i] > MOST_NODES) return fail("the size of the grid is out of range");
    nodes *= map.size[i];
    if (nodes > MOST_NODES) return fail("the grid is too large");
    map.node[i] = calloc(map.size[i], sizeof(double));
    if (map.node[i] == NULL) return -ENOMEM;
  }
  map.value = calloc(nodes, sizeof(*map.value));
  return map.value == NULL ? -ENOMEM : 0;
}

static int read_numbers(const char *line, double *number) {
  char *end;
  int i;
  for (i = 0; i < ROW_VALUES; ++i) {
    number[i] = strtod(line, &end);
    if (end == line || !isfinite(number[i])) return fail("the row does not have 15 numbers");
    line = end;
  }
  return line[strspn(line, " \t\r\n")] == '\0' ? 0 : fail("the row has more than 15 numbers");
}

/* The first row with an index fixes the position of that node; all others must agree. */
static int check_position(const int *index, const double *number) {
  int i;
  for (i = 0; i < AXES; ++i) {
    const int others = index[(i + 1) % AXES] + index[(i + 2) % AXES];
    if (others == 0) {
      map.node[i][index[i]] = number[i];
      if (index[i] > 0 && !(number[i] > map.node[i][index[i] - 1])) return fail("positions do not ascend");
    } else if (number[i] != map.node[i][index[i]]) {
      return fail("the rows are no complete grid, Z fastest");
    }
  }
  return 0;
}

static int read_rows(FILE *file) {
  char line[LONGEST_LINE];
  double number[ROW_VALUES];
  int index[AXES], result;
  long row = 0;
  for (index[0] = 0; index[0] < map.size[0]; ++index[0]) {
    for (index[1] = 0; index[1] < map.size[1]; ++index[1]) {
      for (index[2] = 0; index[2] < map.size[2]; ++index[2]) {
        if (!next_line(file, line)) return fail("rows are missing");
        if ((result = read_numbers(line, number)) != 0) return result;
        if ((result = check_position(index, number)) != 0) return result;
        memcpy(map.value[row++], number + AXES, sizeof(*map.value));
      }
    }
  }
  return next_line(file, line) ? fail("there are more rows than the header says") : 0;
}

static int read_grid(void) {
  int result;
  FILE *file = fopen(grid, "r");
  file_name = grid;
  if (file == NULL) return fail("cannot be opened");
  result = read_header(file);
  if (result == 0) result = read_rows(file);
  fclose(file);
  return result;
}

/* ---- the correction ---- */

/* Lower node of the piece that `position` lies in, and how far along the piece, 0..1. */
static int piece_of(const double *node, int size, double position, double *along) {
  int lower = 0, upper = size - 1;
  *along = 0.0;
  if (upper == 0 || position <= node[0]) return 0;
  if (position >= node[upper]) {
    *along = 1.0;
    return upper - 1;
  }
  while (upper - lower > 1) {
    const int middle = (lower + upper) / 2;
    if (node[middle] <= position)
      lower = middle;
    else
      upper = middle;
  }
  *along = (position - node[lower]) / (node[upper] - node[lower]);
  return lower;
}

static void grid_correction(const double *position, double *sum) {
  int lower[AXES], corner, i, k;
  double along[AXES];
  for (i = 0; i < AXES; ++i) {
    lower[i] = piece_of(map.node[i], map.size[i], position[i], &along[i]);
    sum[i] = 0.0;
  }
  for (corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    const double *value;
    long row = 0;
    for (i = 0; i < AXES; ++i) {
      const int upper = (corner >> i) & 1;
      weight *= upper ? along[i] : 1.0 - along[i];
      row = row * map.size[i] + lower[i] + upper;
    }
    if (weight == 0.0) continue; /* also where there is no upper node */
    value = map.value[row];
    for (k = 0; k < AXES; ++k) {
      double of_node = value[k];
      for (i = 0; i < AXES; ++i) of_node += axis[i].share * value[AXES * (i + 1) + k];
      sum[k] += weight * of_node;
    }
  }
}

#include "volcalkins_rotary.h"

static void correction(const double *position, double *sum) {
  int i;
  grid_correction(position, sum);
  for (i = AXES; i < ALL_AXES; ++i) sum[i] = own_correction(i, position[i]);
  twist_correction(position, sum);
}

static double moved_towards(double from, double to, double step) {
  return fabs(to - from) <= step ? to : from + (to > from ? step : -step);
}

static void start_at_home(int i) {
  axis[i].direction = 1;
  axis[i].share = 1.0;
  axis[i].farthest = **axis[i].position;
}

static void follow_direction(int i, double step) {
  const double position = **axis[i].position;
  if ((position - axis[i].farthest) * axis[i].direction > 0.0) {
    axis[i].farthest = position;
  } else if ((axis[i].farthest - position) * axis[i].direction > TURNED_BY) {
    axis[i].direction = -axis[i].direction;
    axis[i].farthest = position;
  }
  axis[i].share = moved_towards(axis[i].share, axis[i].direction, step);
}

static void follow_directions(void *unused, long period) {
  int i;
  (void)unused;
  if (!**homed.pin) homed.periods = 0;
  if (homed.periods < HOMING_PERIODS) ++homed.periods;
  for (i = 0; i < ALL_AXES; ++i) {
    if (homed.periods < HOMING_PERIODS)
      start_at_home(i);
    else
      follow_direction(i, 2e-9 * period / RAMP_SECONDS);
  }
}

/* ---- the interface of LinuxCNC ---- */

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }

/* Joint of an axis; -1 where the chain lacks it. Without a chain every axis has its place. */
static int joint_of(int i) {
  int joint = AXES, other, k;
  if (i < AXES || chain.joints == 0) return i;
  for (other = AXES; other <= i; ++other) {
    for (k = 0; k < chain.joints && chain.axis[k] != other; ++k) {
    }
    if (k < chain.joints && other == i) return joint;
    if (k < chain.joints) ++joint;
  }
  return -1;
}

int kinematicsInverse(const EmcPose *world, double *joint, const KINEMATICS_INVERSE_FLAGS *iflags,
                      KINEMATICS_FORWARD_FLAGS *fflags) {
  const double position[ALL_AXES] = {world->tran.x, world->tran.y, world->tran.z,
                                     world->a,      world->b,      world->c};
  double added[ALL_AXES];
  int i;
  (void)iflags;
  (void)fflags;
  correction(position, added);
  for (i = 0; i < ALL_AXES; ++i)
    if (joint_of(i) >= 0) joint[joint_of(i)] = position[i] + added[i];
  return 0;
}

/* axis = joint - correction(axis): the correction changes by far less than the position does. */
int kinematicsForward(const double *joint, EmcPose *world, const KINEMATICS_FORWARD_FLAGS *fflags,
                      KINEMATICS_INVERSE_FLAGS *iflags) {
  double told[ALL_AXES], position[ALL_AXES], added[ALL_AXES], change = 0.0;
  int step, i;
  (void)fflags;
  (void)iflags;
  for (i = 0; i < ALL_AXES; ++i) told[i] = position[i] = joint_of(i) >= 0 ? joint[joint_of(i)] : 0.0;
  for (step = 0; step < FORWARD_STEPS; ++step) {
    correction(position, added);
    change = 0.0;
    for (i = 0; i < ALL_AXES; ++i) {
      const double next = told[i] - added[i];
      change = fmax(change, fabs(next - position[i]));
      position[i] = next;
    }
    if (change <= FORWARD_ACCURACY) break;
  }
  if (!(change <= FORWARD_ACCURACY)) return -1;
  world->tran.x = position[0];
  world->tran.y = position[1];
  world->tran.z = position[2];
  world->a = position[3];
  world->b = position[4];
  world->c = position[5];
  world->u = world->v = world->w = 0.0;
  return 0;
}

static int export_pins(void) {
  static const char *const names[ALL_AXES] = {"volcalkins.x", "volcalkins.y", "volcalkins.z",
                                              "volcalkins.a", "volcalkins.b", "volcalkins.c"};
  int i, result;
  for (i = 0; i < ALL_AXES; ++i) {
    axis[i].position = hal_malloc(sizeof(*axis[i].position));
    if (axis[i].position == NULL) return -ENOMEM;
    result = hal_pin_float_new(names[i], HAL_IN, axis[i].position, component);
    if (result != 0) return result;
  }
  homed.pin = hal_malloc(sizeof(*homed.pin));
  if (homed.pin == NULL) return -ENOMEM;
  result = hal_pin_bit_new("volcalkins.homed", HAL_IN, homed.pin, component);
  if (result != 0) return result;
  return hal_export_funct("volcalkins.directions", follow_directions, NULL, 1, 0, component);
}

int rtapi_app_main(void) {
  int result = read_grid();
  if (result == 0) result = read_rotary();
  if (result != 0) return result;
  component = hal_init("volcalkins");
  if (component < 0) return component;
  result = export_pins();
  if (result == 0) result = hal_ready(component);
  if (result != 0) hal_exit(component);
  return result;
}

void rtapi_app_exit(void) { hal_exit(component); }
