/* What the harnesses of the glue for autopilots check with. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>

/* Name the line of what does not hold, and end the program. */
#define CHECK(held)                                       \
  do {                                                    \
    if (!(held)) {                                        \
      (void)printf("line %d: not %s\n", __LINE__, #held); \
      exit(1);                                            \
    }                                                     \
  } while (0)

#endif
