/* The firmware of a vehicle that is flown elsewhere: calls come in by the pipe that the emulator was
 * started with, answers leave by the other. Parameters and state stay on the board. */
#include <fcntl.h>
#include <stdint.h>
#include <unistd.h>

#include "firmware_names.h"

typedef struct {
  uint32_t steps; /* else it is a reset */
  real thrust;    /* N, of a reset */
  input_t in;     /* of a step */
} call_t;

typedef struct {
  uint32_t status;
  state_t state;
  output_t out; /* of a step */
} answer_t;

static int come_in(int pipe, void *data, size_t size) {
  char *bytes = data;
  while (size > 0) {
    const int got = (int)read(pipe, bytes, size);
    if (got <= 0) return 0;
    bytes += got;
    size -= (size_t)got;
  }
  return 1;
}

int main(void) {
  static params_t params;
  static call_t call;
  static answer_t answer;
  const int from = open("/dev/stdin", O_RDONLY), to = open("/dev/stdout", O_WRONLY);
  init(&params);
  while (come_in(from, &call, sizeof call)) {
    answer.status = call.steps ? step(&params, &answer.state, &call.in, &answer.out)
                               : reset_state(&params, &answer.state, call.thrust);
    if (write(to, &answer, sizeof answer) != (int)sizeof answer) return 1;
  }
  return 0;
}
