namespace truebearing {}
