pub mod early;
