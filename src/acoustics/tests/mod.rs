//! The whole way from arrivals to figures, against exact energies.
mod shoebox;
mod waves;
