/* What a library with Pinocchio's algorithms offers: C functions, so that it may be compiled by another compiler, once, and
   loaded where it is found. tests/benchmarks/pinocchio makes it.

   q, v and what comes behind them are as this project has them, which is Pinocchio's layout too; results are in Pinocchio's. */
#pragma once

/* Nothing else of the library is seen from outside: Eigen compiled for other registers must not meet its like. */
#if defined(__GNUC__)
#define DALEMBERT_PINOCCHIO_API __attribute__((visibility("default")))
#else
#define DALEMBERT_PINOCCHIO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dalembert_pinocchio_robot dalembert_pinocchio_robot;

typedef struct {
  int parent;              /* index of the body before it; -1: the base */
  int slides;              /* 0: it turns */
  double axis[3];          /* unit, in the body's frame */
  double rotation[9];      /* of the body's frame in the parent's at q = 0, row by row */
  double translation[3];   /* m */
  double mass, com[3];     /* kg, m */
  double inertia[9];       /* about the centre of mass, kg m^2, row by row */
  double armature;         /* kg m^2 or kg */
} dalembert_pinocchio_body;

/* Element (row, column) of a result stands at values[row * row_step + column * column_step]. */
typedef struct {
  const double* values;
  int row_step, column_step;
} dalembert_pinocchio_result;

/* One call of Pinocchio's, or the calls that it takes, and what these leave behind. */
typedef struct {
  const char* quantities; /* our names, between blanks, in the order of `which` */
  void (*run)(dalembert_pinocchio_robot*, const double* q, const double* v, const double* more);
  dalembert_pinocchio_result (*result)(const dalembert_pinocchio_robot*, int which);
} dalembert_pinocchio_call;

DALEMBERT_PINOCCHIO_API const char* dalembert_pinocchio_version(void);  /* "3.7.0" */
DALEMBERT_PINOCCHIO_API const char* dalembert_pinocchio_compiled(void); /* compiler and flags */
DALEMBERT_PINOCCHIO_API const dalembert_pinocchio_call* dalembert_pinocchio_calls(int* count);

/* base: read where it moves. Null when there is no memory. */
DALEMBERT_PINOCCHIO_API dalembert_pinocchio_robot* dalembert_pinocchio_create(int base_moves, const dalembert_pinocchio_body* base,
                                                      const dalembert_pinocchio_body* bodies, int count, const double* gravity);
DALEMBERT_PINOCCHIO_API void dalembert_pinocchio_destroy(dalembert_pinocchio_robot*);

#ifdef __cplusplus
}
#endif
