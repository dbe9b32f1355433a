/* Repeats a recording with an exported controller and says how far its torques lie apart.
 *
 * A line of the file is a tick: q, v, q_d, v_d, a_d, M row by row, h, dt, and the torque that the
 * controller gave in Python. `examples/export_to_c.py` writes the controller and the file:
 *
 *     gcc -std=c99 -O2 made/fotsmc_panda.c replay.c -Imade -lm -o replay
 *     ./replay made/ticks.txt
 */
#include "fotsmc_panda.h"

#include <math.h>
#include <stdio.h>

enum { NQ = FOTSMC_PANDA_NQ, NV = FOTSMC_PANDA_NV };

static int read_numbers(FILE *file, double *numbers, int count) {
    for (int i = 0; i < count; i++) {
        if (fscanf(file, "%lf", &numbers[i]) != 1) { return 0; }
    }
    return 1;
}

int main(int argc, char **argv) {
    FILE *file = argc == 2 ? fopen(argv[1], "r") : NULL;
    if (file == NULL) {
        fputs("give the file of ticks\n", stderr);
        return 2;
    }
    static fotsmc_panda_state controller;
    fotsmc_panda_init(&controller);

    double q[NQ], v[NV], q_d[NQ], v_d[NV], a_d[NV], M[NV * NV], h[NV], dt, expected[NV], tau[NV];
    double largest = 0.0, apart = 0.0;
    int ticks = 0;
    while (read_numbers(file, q, NQ) && read_numbers(file, v, NV) && read_numbers(file, q_d, NQ)
           && read_numbers(file, v_d, NV) && read_numbers(file, a_d, NV)
           && read_numbers(file, M, NV * NV) && read_numbers(file, h, NV)
           && read_numbers(file, &dt, 1) && read_numbers(file, expected, NV)) {
        const int status = fotsmc_panda_update(&controller, q, v, q_d, v_d, a_d, M, h, dt, tau);
        if (status != FOTSMC_PANDA_OK) {
            fprintf(stderr, "tick %d: status %d\n", ticks, status);
            fclose(file);
            return 1;
        }
        for (int i = 0; i < NV; i++) {
            largest = fmax(largest, fabs(expected[i]));
            apart = fmax(apart, fabs(tau[i] - expected[i]));
        }
        ticks++;
    }
    fclose(file);
    printf("%d ticks, torques up to %.3g N*m, at most %.2g of that apart\n", ticks, largest,
           apart / largest);
    return ticks > 0 && apart <= 1e-12 * largest ? 0 : 1;
}
