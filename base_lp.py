import time, numpy as np, sys
import liepoisson as lp
top = lp.Top.twisted_kovalevskaya()
x0 = lp.sample_states(top, 64, seed=1)
def best(f, n=7):
    b=1e9
    for _ in range(n):
        t=time.perf_counter(); r=f(); b=min(b,time.perf_counter()-t)
    return b*1e3
T=1000.
for span in (1000., 100., 10000.):
    ts=np.linspace(0,span,100001)[1:]
    o=lp.integrate(top,x0[0],times=[0,span],dense=True)
    print('span',span,'steps',o.n_steps, 'dense run ms',best(lambda: lp.integrate(top,x0[0],times=[0,span],dense=True)), 'at ms',best(lambda:o.at(ts)))
    grid=np.concatenate([[0],ts])
    print('  integrate grid ms',best(lambda: lp.integrate(top,x0[0],times=grid)), 'plain', best(lambda: lp.integrate(top,x0[0],times=[0,span])))
grid=np.linspace(0,200,2001)
print('64 orbits grid 2001, t=200',best(lambda: lp.integrate(top,x0,times=grid,threads=1)),'plain',best(lambda: lp.integrate(top,x0,times=[0,200.],threads=1)))
